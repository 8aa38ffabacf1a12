#include "base/columns.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/words.hpp"

namespace clothbench {

Value absent() { return Value::value_t::discarded; }

NumberFormat digits(int n) {
  return [n](double v) { return significant(v, n); };
}

NumberFormat in_form(const char* form) {
  return [form](double v) { return std::isfinite(v) ? fmt::format(fmt::runtime(form), v) : "–"; };
}

std::string printed_value(const Value& v, const NumberFormat& format, const Unit& unit) {
  if (v.is_number() && format) return format(unit.per_si * v.get<double>());
  return v.is_null() || v.is_discarded() ? "–" : csv_value(v);
}

std::string csv_value(const Value& v) {
  if (v.is_string()) return v.get<std::string>();
  if (v.is_number_float()) return csv_number(v.get<double>());
  if (v.is_null() || v.is_discarded()) return "";
  if (!v.is_array()) return v.dump();
  return joined(v, ", ", csv_value);
}

Value json_value(Value v) { return v.is_number_float() && !std::isfinite(v.get<double>()) ? Value() : v; }

}  // namespace clothbench
