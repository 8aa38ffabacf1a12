#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "clothbench/scene.hpp"

namespace clothbench::truth {

/// A scene that holds or slips by its friction: what is found by trying coefficients, against the closed form.
struct Threshold {
  std::string key;          ///< of the scene, what is varied
  double exact = 0;         ///< it holds from here on
  double held_below_m = 0;  ///< |quantity| at the end of a run that held
  std::string error_name, error_units;
  std::function<double(double found)> error;
};

/// The exact answer of one scene with a `truth` block; every parameter is the scene's own. All reference cases are
/// strips along u (or sheets) whose rows move alike, so an answer is one position for each column of the grid, on the
/// middle line of the sheet; a vertex lies at its column's position plus its share of the height along axis_v.
///
/// `columns` is the answer of the same mesh wherever there is one (a chain of as many links, springs, hinges), so that
/// a run's distance from it has no spatial part; `continuum` is the answer without a mesh.
struct ReferenceCase {
  std::string name;
  bool settles = false;      ///< the answer is the shape at rest: only a run's end is compared
  bool by_quantity = false;  ///< runs are ranked by the quantity's error; otherwise by that of the positions
  std::string quantity_name;
  double quantity_scale = 1;       ///< what errors of the quantity are divided by, same unit
  double speed_scale_m_per_s = 1;  ///< the same for speeds

  std::function<std::vector<Vec3>(int frame)> columns;        ///< [m]
  std::function<std::vector<Vec3>(int frame)> column_speeds;  ///< [m/s]; null where there is no answer
  std::function<Vec3(double share, int frame)> continuum;     ///< at a share 0..1 of the width; null: as `columns`
  std::function<double(const std::vector<Vec3>& columns)> quantity;  ///< of a run's columns (means over the rows)
  std::optional<Threshold> threshold;
};

/// The reference case a scene names, or none. Throws Error with the scene's source if the scene is not what the
/// reference case answers.
std::optional<ReferenceCase> reference_case_of(const Scene&);

/// What every reference case's ranking error is, for headings: "E2", "quantity".
std::string ranking_label(const ReferenceCase&);

/// Means over the rows of `values` (3 per vertex), one per column.
std::vector<Vec3> column_means(const Cloth&, const std::vector<double>& values);

/// Vertex values (3 per vertex) of columns; `offset`: with each row's place along axis_v added (positions, not speeds).
std::vector<double> vertex_values(const Cloth&, const std::vector<Vec3>& columns, bool offset);

}  // namespace clothbench::truth
