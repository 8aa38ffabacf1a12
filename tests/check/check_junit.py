"""Parses a JUnit file and compares it with the expected content.

usage: check_junit.py CHECK.xml EXPECTED.json
"""
import json
import sys
import xml.etree.ElementTree as ET


def main():
    root = ET.parse(sys.argv[1]).getroot()
    expected = json.load(open(sys.argv[2], encoding="utf-8"))
    assert root.tag == "testsuites" and [s.tag for s in root] == ["testsuite"]
    cases = root.findall("./testsuite/testcase")
    failed = sum(bool(e["failures"]) for e in expected)
    for element in (root, root[0]):
        assert element.get("tests") == str(len(expected)) and element.get("failures") == str(failed), element.attrib
    assert len(cases) == len(expected)
    for case, want in zip(cases, expected):
        assert (case.get("classname"), case.get("name")) == (want["classname"], want["name"]), case.attrib
        failures, notes = case.findall("failure"), case.findall("system-out")
        assert len(failures) == bool(want["failures"]) and len(notes) == bool(want["notes"])
        for element, quantities in ((failures, want["failures"]), (notes, want["notes"])):
            for quantity in quantities:
                assert f"{quantity}: " in element[0].text, element[0].text
        if failures:
            assert failures[0].text.startswith(failures[0].get("message")), failures[0].get("message")
            text = failures[0].text
            assert 'a <b> & "c", 100 %: d]]>\r\nnext\tline ?? \ufffd? µ' in text, repr(text)


if __name__ == "__main__":
    main()
