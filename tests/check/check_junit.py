"""Compares a JUnit file with the expected content: check_junit.py CHECK.xml EXPECTED.json"""
import json
import sys
import xml.etree.ElementTree as ET

root, expected = ET.parse(sys.argv[1]).getroot(), json.load(open(sys.argv[2], encoding="utf-8"))
assert root.tag == "testsuites" and [s.tag for s in root] == ["testsuite"]
for element in (root, root[0]):
    counts = len(expected), sum(bool(e["failures"]) for e in expected)
    assert (int(element.get("tests")), int(element.get("failures"))) == counts, element.attrib
for case, want in zip(root.findall("./testsuite/testcase"), expected, strict=True):
    assert (case.get("classname"), case.get("name")) == (want["classname"], want["name"]), case.attrib
    for key, tag in (("failures", "failure"), ("notes", "system-out")):
        elements = case.findall(tag)
        assert len(elements) == bool(want[key]) and all(f"{quantity}: " in elements[0].text for quantity in want[key]), (want, elements)
    for failure in case.findall("failure"):
        assert failure.text.startswith(failure.get("message")), failure.get("message")
        assert 'a <b> & "c", 100 %: d]]>\r\nnext\tline ?? \ufffd? µ' in failure.text, repr(failure.text)
