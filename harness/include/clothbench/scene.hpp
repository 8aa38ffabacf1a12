#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "clothbench/collider.hpp"
#include "clothbench/feature.hpp"

namespace clothbench {

/// The paper's "single-sided" and "double-sided" cloths; see docs of `cloth.sides` in the schema.
enum class Sides { Single, DoubleDuplicated, Double };

/// Where vertices start that do not start at rest: everything that is not pinned, unless said otherwise. Seeded, so
/// that one seed is one start, bit for bit.
struct Start {
  /// Sphere: uniform on a sphere. Plane: uniform on a disc in the sheet's plane. Line: on its middle line along u.
  /// Point: all at its centre. Folded: folded along u like a map, fold on fold.
  enum class Shape : std::uint8_t { Rest, Sphere, Plane, Line, Point, Folded };
  Shape shape = Shape::Rest;
  double radius_m = 0;  ///< of the sphere or the disc
  int folds = 0;        ///< leaves of a folded sheet
  double noise_m = 0;   ///< standard deviation of every coordinate
  std::uint64_t seed = 0;
  std::vector<std::vector<std::uint32_t>> merged;  ///< all vertices of a list start where its first one does
  struct Move {
    std::vector<std::uint32_t> vertices;
    Vec3 by_m{};
  };
  std::vector<Move> moved;  ///< pinned ones too: they are then held there

  bool at_rest() const { return shape == Shape::Rest && noise_m == 0 && merged.empty() && moved.empty(); }
};

enum class EdgeKind : std::uint8_t { Structural, Shear, SkipOne };
struct Edge {
  std::uint32_t a, b;
  double rest_m;
  EdgeKind kind;
};

/// A cloth of any shape and topology, at rest, in the frame of axis_u, axis_v and axis_u x axis_v round center_m.
struct ClothMesh {
  std::vector<Vec3> vertices;                           ///< [m]
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< of positive area
  std::vector<Edge> edges;                              ///< each once, all structural, a < b, ascending
  std::vector<double> areas_m2;                         ///< of each edge, the sum of its triangles' areas
  double edge_m = 0;                                    ///< mean length of an edge
};

/// How a cloth touches itself.
struct SelfCollision {
  double thickness_m = 0;  ///< distance that two layers keep; 0: it does not touch itself
  double friction = 0;     ///< Coulomb's, of cloth on cloth
};

/// Rectangular sheet, or a triangle mesh. Vertex (i, j) has index j*columns + i, material coordinates (i*du, j*dv), and
/// lies in the plane spanned by `axis_u` and `axis_v` (orthonormal) around `center_m`.
struct Cloth {
  int columns = 0, rows = 0;         ///< vertices along u and v, each >= 2; of a mesh: all its vertices, and 1
  double width_m = 0, height_m = 0;  ///< rest length along u and v; of a mesh: the two longest sides of its box
  std::shared_ptr<const ClothMesh> mesh = nullptr;  ///< null: the grid
  double areal_density_kg_per_m2 = 0;
  Sides sides = Sides::Single;
  Vec3 center_m{}, axis_u{}, axis_v{};
  /// Above 0: starts bent along u into an arc, towards axis_u x axis_v, its edges u0 and u1 this far apart.
  double span_m = 0;
  /// Above 0: starts over a cylinder along axis_v round center_m, its rows this far from the axis where they touch and
  /// hanging along axis_u x axis_v elsewhere, its middle `drape_offset_m` from the top, towards u1.
  double drape_radius_m = 0, drape_offset_m = 0;
  Vec3 initial_velocity_m_per_s{};
  Vec3 spin_rad_per_s{};               ///< about center_m, on top of the velocity
  std::vector<double> column_factors;  ///< relative width of every cell along u; empty = all alike. They fill width_m
  std::vector<double> mass_factors;    ///< one per vertex; empty = all 1
  Start start;
  SelfCollision self_collision;

  std::size_t vertex_count() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
  double du() const { return mesh ? mesh->edge_m : width_m / (columns - 1); }
  double dv() const { return mesh ? mesh->edge_m : height_m / (rows - 1); }
  /// Rest coordinate of grid line `i` along u, 0 to width_m, whatever the cells' widths; du() is their mean.
  double line_u_m(int i) const;
  /// Least height of a triangle at rest. Parts of a flat sheet that share no vertex are at least so far apart.
  double least_height_m() const;
};

/// A membrane stiffness of the cells of columns `first` to `last` (the first cell is 0), instead of the sheet's.
struct StiffnessRegion {
  int first = 0, last = 0;
  std::optional<double> membrane_stiffness_N_per_m;
};

/// Continuum data only; every solver maps it onto its own model and says how (its README).
struct Material {
  std::optional<double> membrane_stiffness_N_per_m;  ///< Y = E h; empty = inextensible
  double bending_rigidity_N_m = 0;                   ///< B; 0 = bending off
  bool shear = true;                                 ///< false: strips that do not feel one another, no diagonals
  double damping_per_s = 0;                          ///< mass-proportional: dv/dt = -c v
  std::vector<StiffnessRegion> regions;              ///< later ones over earlier ones
};

/// Vertices held at their initial position for the whole run.
struct Pins {
  std::vector<std::uint32_t> vertices;
};

/// Vertices that hands hold and move. They are held from t = 0 (see FrameMotion::grip_held) until they are let go, and
/// are never held again.
struct Grips {
  std::vector<std::uint32_t> vertices;
};

struct TimeSpan {
  double frame_rate_hz = 0;
  double duration_s = 0;
  double dt() const { return 1.0 / frame_rate_hz; }
  int frames() const { return static_cast<int>(duration_s * frame_rate_hz + 0.5); }
  /// Ends of the frames where they are not all alike (a hitch, a jitter), frames() + 1 of them from 0 on; empty = even.
  std::vector<double> ends_s = {};
  /// Time at the end of frame `frame` (0: the start), and the length of frame `frame` + 1.
  double at(int frame) const { return ends_s.empty() ? frame * dt() : ends_s.at(static_cast<std::size_t>(frame)); }
  double dt_after(int frame) const { return ends_s.empty() ? dt() : at(frame + 1) - at(frame); }
};

/// A grip or a collider that is somewhere else from one frame to the next.
struct Jump {
  int frame = 0;  ///< at whose end it has jumped; the first is 1
  double distance_m = 0;
};

/// How a run of the scene is judged frame by frame, by the classes F0 to F8 of metrics/stability.
struct StabilityRules {
  std::string name;           ///< of the case: "S01"; empty = not judged
  std::uint32_t judged = 0;   ///< bit k: class Fk counts
  bool when_relaxed = false;  ///< F1 to F3 count from the first frame on whose mean |strain| is below 1 %
  double relax_s = 0;         ///< it is to come by then; 0 = whenever
  double settle_s = 0;        ///< F6 counts from here on
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

  std::vector<Jump> jumps;
  StabilityRules stability;
  std::optional<std::uint64_t> seed;  ///< its parameters were drawn by this number
  std::string reference_case;         ///< of the exact answer, "" = none; see harness/truth/reference_case.hpp

  /// Where vertex (i, j) starts [m].
  Vec3 rest_position(int i, int j) const;
  /// Motion at the end of frame `index` (0 = the first); null where nothing moves. Stands still after the scene's end.
  const FrameMotion* motion_after(int index) const;
};

/// Lumped vertex masses [kg], size vertex_count: quarter of each adjacent cell ("quad-lumped": interior rho*du*dv,
/// edge half, corner quarter), times the vertex's factor. Of a mesh a third of each adjacent triangle.
std::vector<double> vertex_masses(const Scene&);

/// Initial positions [m], size 3*vertex_count, xyz interleaved.
std::vector<double> initial_positions(const Scene&);

/// Initial velocities [m/s], size 3*vertex_count, xyz interleaved: velocity and spin, about the centre of the sheet.
/// What is pinned has one too; a solver holds it all the same.
std::vector<double> initial_velocities(const Scene&);

/// Y of a structural or shear edge [N/m], of the cell it lies in or (across u) the mean of its two; empty =
/// inextensible.
std::optional<double> membrane_stiffness(const Scene&, const struct Edge&);

/// The cell a structural or shear edge belongs to [m]: its side along the edge (along u for a diagonal) and the side
/// across, which for an edge along v is the mean of its two columns'. An edge on the border carries half of it. Of a
/// mesh (border included): the edge, and the areas of its triangles over its length, so that Y across/along is the
/// spring of Van Gelder 1998 ("Approximate simulation of elastic membranes by triangulated spring meshes"), which on
/// equilateral triangles makes a sheet of exactly Y with Poisson ratio 1/3.
struct EdgeCell {
  double along_m = 0, across_m = 0;
};
EdgeCell edge_cell(const Cloth&, const struct Edge&);

/// Whether an edge lies along the border of a grid, where a spring stands for half as much cloth: never a diagonal, and
/// never one of a mesh, whose areas say it already (see EdgeCell).
bool on_border(const Cloth&, const struct Edge&);

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

/// Grid edges of one kind with their rest lengths, in a fixed order. All edges of a mesh are structural.
std::vector<Edge> edges(const Cloth&, EdgeKind);

}  // namespace clothbench
