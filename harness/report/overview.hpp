#pragma once
#include <string>
#include <utility>
#include <vector>

#include "report/view.hpp"

namespace clothbench {

/// A number of the first screen, of the best solver present, with its interval; `others`: the solvers that follow.
struct Tile {
  std::string title, value, interval, others;
};

/// At most four tiles: rate, error, generated contact, contact, stability, as far as the runs have them.
std::vector<Tile> tiles_of(const RunTable&);

/// Title of a report and what its runs state of device, commit, date and trials.
struct Heading {
  std::string title;
  std::vector<std::pair<std::string, std::string>> facts;
};
Heading heading_of(const RunTable&, const std::vector<std::string>& studies);

}  // namespace clothbench
