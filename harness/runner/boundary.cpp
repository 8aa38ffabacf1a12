#include "runner/boundary.hpp"

#include <cmath>
#include <cstdlib>
#include <limits>

#include "clothbench/error.hpp"

namespace clothbench {
namespace {

double number(const std::string& text, const std::string& whole) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !std::isfinite(value))
    throw Error("\"" + whole + "\": expected a product of numbers, x, y and powers of them such as x^-1");
  return value;
}

}  // namespace

Boundary find_boundary(const std::vector<double>& values, double decades, int after_bad,
                       const std::function<bool(double)>& good) {
  Boundary b{0, std::numeric_limits<double>::infinity()};
  int beyond = 0;
  for (double x : values) {
    const bool turned = std::isfinite(b.first_bad);
    if (turned && beyond++ >= after_bad) break;
    const bool is_good = good(x);
    if (turned) continue;
    (is_good ? b.last_good : b.first_bad) = x;
  }
  if (b.last_good == 0 || !std::isfinite(b.first_bad)) return b;
  while (std::log10(b.first_bad / b.last_good) > decades) {
    const double middle = std::sqrt(b.last_good * b.first_bad);
    (good(middle) ? b.last_good : b.first_bad) = middle;
  }
  return b;
}

double evaluate(const std::string& expression, double x, double y) {
  double out = 1;
  std::size_t from = 0;
  std::string rest = expression;
  if (!rest.empty() && rest[0] == '-' && rest.size() > 1 && (rest[1] == 'x' || rest[1] == 'y')) {
    out = -1;
    rest.erase(0, 1);
  }
  while (from <= rest.size()) {
    const std::size_t to = std::min(rest.find('*', from), rest.size());
    const std::string factor = rest.substr(from, to - from);
    from = to + 1;
    if (factor.empty() || (factor[0] != 'x' && factor[0] != 'y')) {
      out *= number(factor, expression);
      continue;
    }
    const double base = factor[0] == 'x' ? x : y;
    if (factor.size() == 1)
      out *= base;
    else if (factor[1] == '^')
      out *= std::pow(base, number(factor.substr(2), expression));
    else
      number(factor, expression);
  }
  return out;
}

}  // namespace clothbench
