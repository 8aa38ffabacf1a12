#include "report/bytes.hpp"

#include <algorithm>
#include <cmath>

#include "base/table.hpp"
#include "report/grid.hpp"

namespace clothbench {

bool reads_at_least(const RunRecord& c) {
  return std::any_of(c.header.stages.begin(), c.header.stages.end(),
                     [](const StageRecord& s) { return s.bytes == "at least"; });
}

std::string bytes_read(const RunRecord& c, double value, int digits) {
  return std::isfinite(value) && reads_at_least(c) ? "≥ " + significant(value, digits) : significant(value, digits);
}

std::string bytes_pair(const RunRecord& c, const char* read, const char* written, double scale) {
  const double in = scale * summary_value(c, read), out = scale * summary_value(c, written);
  if (!std::isfinite(in) && !std::isfinite(out)) return "–";
  return bytes_read(c, in, 3) + " / " + significant(out, 3);
}

}  // namespace clothbench
