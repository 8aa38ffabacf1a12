#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "clothbench/collider.hpp"
#include "clothbench/feature.hpp"

namespace clothbench {

/// How the paper's "single-sided" and "double-sided" cloths are told apart; see docs of `cloth.sides` in the schema.
enum class Sides { Single, DoubleDuplicated, Double };

/// Rectangular sheet. Vertex (i, j) has index j*columns + i, material coordinates (i*du, j*dv), and lies in the plane
/// spanned by `axis_u` and `axis_v` (orthonormal) around `center_m`.
struct Cloth {
  int columns = 0, rows = 0;      ///< vertices along u and v, each >= 2
  double width_m = 0, height_m = 0;  ///< rest length along u and v
  double areal_density_kg_per_m2 = 0;
  Sides sides = Sides::Single;
  Vec3 center_m{}, axis_u{}, axis_v{};
  /// Above 0: starts bent along u into an arc, towards axis_u x axis_v, its edges u0 and u1 this far apart.
  double span_m = 0;
  /// Above 0: starts over a cylinder along axis_v round center_m, its rows this far from the axis where they touch and
  /// hanging along axis_u x axis_v elsewhere, its middle `drape_offset_m` from the top, towards u1.
  double drape_radius_m = 0, drape_offset_m = 0;
  Vec3 initial_velocity_m_per_s{};

  std::size_t vertex_count() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
  double du() const { return width_m / (columns - 1); }
  double dv() const { return height_m / (rows - 1); }
};

/// Continuum data only; every solver maps it onto its own model and says how (its README).
struct Material {
  std::optional<double> membrane_stiffness_N_per_m;  ///< Y = E h; empty = inextensible
  double bending_rigidity_N_m = 0;                   ///< B; 0 = bending off
  bool shear = true;                                 ///< false: strips that do not feel one another, no diagonals
  double damping_per_s = 0;                          ///< mass-proportional: dv/dt = -c v
};

/// Vertices held at their initial position for the whole run.
struct Pins {
  std::vector<std::uint32_t> vertices;
};

/// Vertices that hands hold and move. They are held from t = 0 (see FrameMotion::grip_held) and free for good once let
/// go.
struct Grips {
  std::vector<std::uint32_t> vertices;
};

struct TimeSpan {
  double frame_rate_hz = 0;
  double duration_s = 0;
  double dt() const { return 1.0 / frame_rate_hz; }
  int frames() const { return static_cast<int>(duration_s * frame_rate_hz + 0.5); }
};

/// What a right result looks like: a bound on a scalar of the summary.
struct Expectation {
  std::string name;
  std::optional<double> at_least, at_most;
};

/// The completed scene: what runs and what is stored. Plain data, SI units, right-handed, +y up.
struct Scene {
  std::string name, why;
  Cloth cloth;
  Material material;
  Pins pins;
  Grips grips;
  std::vector<Collider> colliders;
  /// Of frame 0 (the start) to frame time.frames(), so frames() + 1 of them; empty where nothing moves.
  std::vector<FrameMotion> motion;
  Vec3 gravity_m_per_s2{};
  TimeSpan time;
  FeatureSet needs;
  std::string expected_outcome;  ///< a status of Outcome, "" = any
  std::vector<Expectation> expect;
  std::string json;    ///< completed scenario, canonical dump
  std::string sha256;  ///< of `json`
  std::string source;  ///< path of the file it came from, for messages
  std::string assets;  ///< where rooms and hands came from: "npm", "procedural", or "" if the scene has none

  std::optional<std::uint64_t> seed;  ///< its parameters were drawn by this number
  std::string truth_card;  ///< of the exact answer, "" = none; see harness/truth/card.hpp

  /// Where vertex (i, j) starts [m].
  Vec3 rest_position(int i, int j) const;
  /// Motion at the end of frame `index` (0 = the first); null where nothing moves. Stands still after the scene's end.
  const FrameMotion* motion_after(int index) const;
};

/// Lumped vertex masses [kg], size vertex_count: quarter of each adjacent cell ("quad-lumped": interior rho*du*dv,
/// edge half, corner quarter).
std::vector<double> vertex_masses(const Scene&);

/// Initial positions [m], size 3*vertex_count, xyz interleaved.
std::vector<double> initial_positions(const Scene&);

/// Turn [rad] from one row on the cylinder to the next, of a sheet that starts draped. Needs drape_radius_m > du/2.
double drape_turn_rad(const Cloth&);
/// Where row `i` of a draped sheet lies [m] that has run `offset_m` towards u1, middle line of the sheet.
Vec3 draped_row(const Cloth&, int i, double offset_m);

/// Vertices of an edge: "u0" and "u1" run along v, "v0" and "v1" along u; ascending.
std::vector<std::uint32_t> edge_vertices(const Cloth&, const std::string& edge);
/// The same and the grid line beside it, whose being held keeps the edge's direction too.
std::vector<std::uint32_t> clamp_vertices(const Cloth&, const std::string& edge);

/// Triangles of the render and metric mesh, 3 indices each, 2 per cell, all wound alike (normal = axis_u x axis_v).
std::vector<std::array<std::uint32_t, 3>> triangles(const Cloth&);

enum class EdgeKind : std::uint8_t { Structural, Shear, SkipOne };
struct Edge {
  std::uint32_t a, b;
  double rest_m;
  EdgeKind kind;
};

/// Grid edges of one kind with their rest lengths, in a fixed order.
std::vector<Edge> edges(const Cloth&, EdgeKind);

}  // namespace clothbench
