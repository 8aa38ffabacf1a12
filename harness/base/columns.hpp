#pragma once
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "base/table.hpp"

namespace clothbench {

/// A value of a table: a string, number or boolean. A missing value is null or not finite.
using Value = nlohmann::json;

/// Unit of printed numbers. The heading shows `name`; one SI unit equals `per_si` of this unit.
struct Unit {
  const char* name = "";
  double per_si = 1;
};
inline constexpr Unit kMilliseconds{"ms", 1e3};

/// Formats a number that is already in its column's unit.
using NumberFormat = std::function<std::string(double)>;
NumberFormat digits(int significant_digits);

/// Whether files contain a column.
enum class In { Neither, Both };

/// A column over records. With a head it is printed, under head and unit; with a key it is in CSV files, under that
/// key.
template <class Record>
struct Column {
  using Get = std::function<Value(const Record&)>;

  std::string key, head;
  Get value;
  NumberFormat format;
  Unit unit;
  In in;

  Column(std::string k, std::string h, Get v, NumberFormat f = {}, Unit u = {})
      : key(std::move(k)),
        head(std::move(h)),
        value(std::move(v)),
        format(std::move(f)),
        unit(u),
        in(key.empty() ? In::Neither : In::Both) {}
  /// A column that is stored but not printed.
  Column(std::string k, In where, Get v) : key(std::move(k)), value(std::move(v)), in(where) {}
};

/// The forms of one value. Printed: "–" if it is missing. CSV: full precision, empty if it is missing.
std::string printed_value(const Value&, const NumberFormat&, const Unit&);
std::string csv_value(const Value&);

/// A typed table. Its columns turn any range of records into each output format.
template <class Record>
struct Columns : std::vector<Column<Record>> {
  using std::vector<Column<Record>>::vector;

  Columns& add(const Columns& more) {
    this->insert(this->end(), more.begin(), more.end());
    return *this;
  }

  /// `t` with a header and one row per record, for the console, Markdown and the page.
  template <class Records>
  Table table(Table t, const Records& records) const {
    fill(
        t.rows, records, [](const auto& c) { return !c.head.empty() || c.in == In::Neither; },
        [](const auto& c) { return *c.unit.name == 0 ? c.head : c.head + " [" + c.unit.name + "]"; },
        [](const auto& c, const Value& v) { return printed_value(v, c.format, c.unit); });
    return t;
  }

  template <class Records>
  std::string csv(const Records& records) const {
    std::vector<std::vector<std::string>> rows;
    fill(
        rows, records, [](const auto& c) { return c.in == In::Both; }, [](const auto& c) { return c.key; },
        [](const auto&, const Value& v) { return csv_value(v); });
    std::string out;
    for (const auto& row : rows) out += csv_row(row);
    return out;
  }

 private:
  template <class Records, class Has, class Head, class Text>
  void fill(std::vector<std::vector<std::string>>& rows, const Records& records, Has has, Head head, Text text) const {
    rows.emplace_back();
    for (const Column<Record>& c : *this)
      if (has(c)) rows.back().push_back(head(c));
    for (const Record& r : records) {
      rows.emplace_back();
      for (const Column<Record>& c : *this)
        if (has(c)) rows.back().push_back(text(c, c.value(r)));
    }
  }
};

}  // namespace clothbench
