#pragma once
#include <string>
#include <vector>

#include "runner/study_runner.hpp"

namespace clothbench {

/// Names of all cells of the plan, in the order that numbers them from 0.
std::vector<std::string> cell_names(const CellPlan&);

/// "7", "3-5" (both ends belong to it) or a list of these, "0,3-5,9" -> ascending numbers. Throws Error on anything
/// else and on numbers that are not below `count`.
std::vector<std::size_t> parse_cells(const std::string& text, std::size_t count);

/// The plan with these cells alone, their groups kept.
CellPlan only_cells(CellPlan, const std::vector<std::size_t>& cells);

}  // namespace clothbench
