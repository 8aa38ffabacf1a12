#include "runner/run_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <set>
#include <sstream>

#include "clothbench/error.hpp"

namespace clothbench {

std::vector<std::string> run_names(const RunPlan& plan) {
  std::vector<std::string> names;
  for (const auto& group : plan.groups)
    for (const RunSpec& c : group) names.push_back(run_name(c));
  return names;
}

std::vector<std::size_t> parse_runs(const std::string& text, std::size_t count) {
  const auto fail = [&] {
    throw Error(fmt::format("--job {}: expected numbers from 0 to {}, such as 7 or 0,3-5", text, count - 1));
  };
  const auto number = [&](const std::string& word) {
    std::size_t n = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), n);
    if (error != std::errc() || end != word.data() + word.size() || n >= count) fail();
    return n;
  };
  std::set<std::size_t> chosen;
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');) {
    const std::size_t dash = part.find('-');
    const std::size_t first = number(part.substr(0, dash)),
                      last = dash == std::string::npos ? first : number(part.substr(dash + 1));
    if (last < first) fail();
    for (std::size_t k = first; k <= last; ++k) chosen.insert(k);
  }
  if (chosen.empty()) fail();
  return {chosen.begin(), chosen.end()};
}

RunPlan only_runs(RunPlan plan, const std::vector<std::size_t>& runs) {
  std::size_t at = 0;
  for (auto& group : plan.groups)
    std::erase_if(group, [&](const RunSpec&) { return !std::binary_search(runs.begin(), runs.end(), at++); });
  std::erase_if(plan.groups, [](const auto& group) { return group.empty(); });
  return plan;
}

}  // namespace clothbench
