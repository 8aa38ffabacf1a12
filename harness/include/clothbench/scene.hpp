#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "clothbench/collider.hpp"
#include "clothbench/feature.hpp"

namespace clothbench {

/// The paper's "single-sided" and "double-sided" cloths; see `cloth.sides` in the schema.
enum class Sides { Single, DoubleDuplicated, Double };

/// Initial state of a sheet that does not start at rest. It applies to all vertices that are not pinned, unless stated
/// otherwise. Equal seeds give bit-identical starts.
struct Start {
  /// Sphere: uniform on a sphere. Plane: uniform on a disc in the sheet's plane. Line: on the sheet's middle line along
  /// u. Point: all at the sheet's centre. Folded: folded along u in a zigzag like a map.
  enum class Shape : std::uint8_t { Rest, Sphere, Plane, Line, Point, Folded };
  Shape shape = Shape::Rest;
  double radius_m = 0;  ///< radius of the sphere or the disc
  int folds = 0;        ///< layers of a folded sheet
  double noise_m = 0;   ///< standard deviation of the noise on every coordinate
  std::uint64_t seed = 0;
  std::vector<std::vector<std::uint32_t>> merged;  ///< vertices of a list, also pinned ones, start at the first one
  struct Move {
    std::vector<std::uint32_t> vertices;
    Vec3 by_m{};
  };
  std::vector<Move> moved;  ///< pinned vertices too, which are then held at the new position

  bool at_rest() const { return shape == Shape::Rest && noise_m == 0 && merged.empty() && moved.empty(); }
};

enum class EdgeKind : std::uint8_t { Structural, Shear, SkipOne };
struct Edge {
  std::uint32_t a, b;
  double rest_m;
  EdgeKind kind;
};

/// A cloth of any shape and topology. Its local frame has origin center_m and axes axis_u, axis_v, axis_u x axis_v.
struct ClothMesh {
  std::vector<Vec3> vertices;                           ///< [m]; initial positions and, without pattern, rest shape
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< each has a positive area; all are wound alike
  std::vector<Edge> edges;                              ///< each edge once, all structural, a < b, ascending order
  std::vector<double> areas_m2;                         ///< per edge: the sum of the areas of its triangles
  double edge_m = 0;                                    ///< mean length of an edge
  /// Rest shape of each triangle: its corners in the plane of its pattern [m]. Empty: `vertices` are the rest shape. At
  /// seams, a vertex has different positions in different triangles.
  std::vector<std::array<std::array<double, 2>, 3>> pattern_m;
  std::map<std::string, std::vector<std::uint32_t>> groups;  ///< vertices by the file's names, ascending
  std::size_t welded_vertices = 0;                           ///< vertices of the file that were merged into others
};

/// Corners [m] of a triangle's rest shape, in the mesh's local frame or in the plane of its pattern.
std::array<Vec3, 3> rest_corners(const ClothMesh&, std::size_t triangle);

/// Contact of a cloth with itself.
struct SelfCollision {
  double thickness_m = 0;  ///< distance between two layers in contact; 0: self-collision is off
  double friction = 0;     ///< Coulomb coefficient of cloth on cloth
};

/// A rectangular sheet or a triangle mesh. Vertex (i, j) of a sheet has index j*columns + i and material coordinates
/// (i*du, j*dv). The sheet lies in the plane through `center_m` along `axis_u` and `axis_v` (orthonormal).
struct Cloth {
  int columns = 0, rows = 0;         ///< vertices along u and v, each >= 2; for a mesh: vertex count and 1
  double width_m = 0, height_m = 0;  ///< rest lengths along u and v; mesh: longest sides of its largest piece's box
  std::shared_ptr<const ClothMesh> mesh = nullptr;  ///< null for a grid
  double areal_density_kg_per_m2 = 0;
  Sides sides = Sides::Single;
  Vec3 center_m{}, axis_u{}, axis_v{};
  /// Distance between u0 and u1 if the sheet starts as an arc along u, bent towards axis_u x axis_v; 0: no arc.
  double span_m = 0;
  /// If drape_radius_m is above 0, the sheet starts draped over a cylinder along axis_v through center_m. Rows that
  /// touch the cylinder are `drape_radius_m` from its axis; the others hang along axis_u x axis_v. The middle
  /// of the sheet is `drape_offset_m` from the top, towards u1.
  double drape_radius_m = 0, drape_offset_m = 0;
  Vec3 initial_velocity_m_per_s{};
  Vec3 spin_rad_per_s{};               ///< about center_m, on top of the velocity
  std::vector<double> column_factors;  ///< relative widths of the cells along u, which fill width_m; empty = all equal
  std::vector<double> mass_factors;    ///< one per vertex; empty = all 1
  Start start;
  SelfCollision self_collision;

  std::size_t vertex_count() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
  double du() const { return mesh ? mesh->edge_m : width_m / (columns - 1); }
  double dv() const { return mesh ? mesh->edge_m : height_m / (rows - 1); }
  /// Rest coordinate [m] of grid line `i` along u, 0 to width_m. Cells may differ in width; du() is the mean.
  double line_u_m(int i) const;
  /// Smallest height [m] of a triangle at rest. Parts of a flat sheet that share no vertex are at least this far apart.
  double least_height_m() const;
};

/// A membrane stiffness for the cells of columns `first` to `last` (from 0) of a grid, or for some triangles of a mesh.
struct StiffnessRegion {
  int first = 0, last = 0;
  std::optional<double> membrane_stiffness_N_per_m;
  std::vector<std::uint32_t> triangles = {};  ///< only of meshes, ascending: triangles with all vertices in the group
};

/// Continuum parameters. Each solver maps them onto its own model, as its README explains.
struct Material {
  std::optional<double> membrane_stiffness_N_per_m;  ///< Y = E h; empty = inextensible
  double bending_rigidity_N_m = 0;                   ///< B; 0 = bending off
  bool shear = true;                                 ///< false: no diagonals; the sheet behaves as independent strips
  double damping_per_s = 0;                          ///< mass-proportional: dv/dt = -c v
  std::vector<StiffnessRegion> regions;              ///< a later region overrides an earlier one
};

/// Vertices held at their initial position for the whole run.
struct Pins {
  std::vector<std::uint32_t> vertices;
};

/// Vertices with prescribed motion, attached to hands or bars from t = 0 until release (FrameMotion::grip_held).
struct Grips {
  std::vector<std::uint32_t> vertices;
};

struct TimeSpan {
  double frame_rate_hz = 0;
  double duration_s = 0;
  double dt() const { return 1.0 / frame_rate_hz; }
  int frames() const { return static_cast<int>(duration_s * frame_rate_hz + 0.5); }
  /// End times [s] of frames of unequal length (hitch, jitter): frames() + 1 values from 0 on. Empty: equal lengths.
  std::vector<double> ends_s = {};
  /// Time [s] at the end of frame `frame` (0: the start), and duration [s] of frame `frame` + 1.
  double at(int frame) const { return ends_s.empty() ? frame * dt() : ends_s.at(static_cast<std::size_t>(frame)); }
  double dt_after(int frame) const { return ends_s.empty() ? dt() : at(frame + 1) - at(frame); }
};

/// An instantaneous displacement of a grip or a collider between two frames.
struct Jump {
  int frame = 0;  ///< the first frame that ends after the jump, counted from 1
  double distance_m = 0;
};

/// Rules by which metrics/stability assigns outcome classes to the frames of a run.
struct StabilityRules {
  std::string name;           ///< name of the case, such as "S01"; empty = not evaluated
  std::uint32_t judged = 0;   ///< bit k: class Fk is evaluated
  bool when_relaxed = false;  ///< F1 and F2 are evaluated from the first frame with mean |strain| below 1 %
  double relax_s = 0;         ///< if that frame comes after this time [s], the run gets F2; 0 = no limit
  double settle_s = 0;        ///< a shape at rest is evaluated from this time [s] on
};

/// How a scene without an exact solution gets a converged one (runner/reference.hpp).
struct Converged {
  int substeps = 0;    ///< per frame; 0: the scene asks for none
  int starts = 0;      ///< runs whose mean is the solution
  double nudge_m = 0;  ///< maximum displacement of a start along each axis
  std::optional<std::array<int, 2>> fine_grid =
      {};  ///< vertices along u and v; the error of the mesh is measured there
};

/// A criterion for a correct result: bounds on a scalar of the summary.
struct Expectation {
  std::string name;
  std::optional<double> at_least, at_most;
};

/// The resolved scene, which is run and stored. Plain data, SI units, right-handed coordinates, +y up.
struct Scene {
  std::string name, why;
  Cloth cloth;
  Material material;
  Pins pins;
  Grips grips;
  std::vector<Collider> colliders;
  /// time.frames() + 1 states, the first at the start; empty if grips and colliders are static.
  std::vector<FrameMotion> motion;
  Vec3 gravity_m_per_s2{};
  TimeSpan time;
  FeatureSet needs;
  std::string expected_outcome;  ///< an Outcome::status; "" = any
  std::vector<Expectation> expect;
  std::string json;    ///< resolved scenario, canonical dump
  std::string sha256;  ///< hash of `json`
  std::string source;  ///< path of the file it came from, for messages
  std::string assets;  ///< origin of rooms and hands: "npm", "procedural", or "" if the scene has none

  std::vector<Jump> jumps;
  StabilityRules stability;
  std::optional<std::uint64_t> seed;  ///< the random seed from which its parameters were sampled
  std::string reference_case;         ///< name of the exact solution, "" = none; see harness/truth/reference_case.hpp
  Converged converged;

  /// Initial position [m] of vertex (i, j).
  Vec3 rest_position(int i, int j) const;
  /// Motion at the end of frame `index` (0 = the first). Null if `motion` is empty; constant after the scene's end.
  const FrameMotion* motion_after(int index) const;
};

/// Lumped vertex masses [kg], size vertex_count. A grid vertex has a quarter of each adjacent cell ("quad-lumped":
/// interior rho*du*dv, edge half, corner quarter), a mesh vertex a third of each triangle; times its mass factor.
std::vector<double> vertex_masses(const Scene&);

/// Initial positions [m], size 3*vertex_count, xyz interleaved.
std::vector<double> initial_positions(const Scene&);

/// Initial velocities [m/s], size 3*vertex_count, xyz interleaved: velocity + spin about center_m, even if pinned.
std::vector<double> initial_velocities(const Scene&);

/// Y [N/m] of a structural or shear edge. Grid: Y of its cell; for an edge along v, the mean of its two cells. Mesh:
/// mean of its triangles, weighted by area. Empty = inextensible.
std::optional<double> membrane_stiffness(const Scene&, const struct Edge&);
/// Y [N/m] of each triangle of a mesh; empty = inextensible.
std::vector<std::optional<double>> triangle_stiffnesses(const Scene&);
/// `membrane_stiffness` of every structural edge of a grid or mesh, in the order of edges().
std::vector<std::optional<double>> edge_stiffnesses(const Scene&);

/// Sides [m] of the cell that a structural or shear edge stands for: along the edge (along u for a diagonal) and across
/// it. For an edge along v, the side across is the mean of the two columns. On a grid's border the cell keeps its full
/// width, and the spring is halved. Edge of a mesh (border included): its length, and the area of its triangles over
/// that length. Y across/along is then the spring of Van Gelder 1998 ("Approximate simulation of elastic membranes by
/// triangulated spring meshes"); equilateral triangles give a sheet with exactly Y and Poisson ratio 1/3.
struct EdgeCell {
  double along_m = 0, across_m = 0;
};
EdgeCell edge_cell(const Cloth&, const struct Edge&);

/// Whether an edge is on the border of a grid, where a spring stands for half as much cloth. False for a diagonal, and
/// for every edge of a mesh, whose areas already account for the border (see EdgeCell).
bool on_border(const Cloth&, const struct Edge&);

/// Springs [N/m] in a sheet of uniaxial stiffness Y [N/m]. With shear, the homogenised sheet is isotropic with Poisson
/// ratio 1/3, the only one that central springs allow (C12 = C66). An inner edge gets Y (9/8 across/along - 3/8
/// along/across), a diagonal 3/16 Y (along^2 + across^2)/(along across); on square cells, 3/4 Y and 3/8 Y.
/// An inner edge with along/across above about 1.6 gets the minimum, a tenth of Y across/along: the sheet is then
/// stiffer than Y. Without shear: Y across/along.
double grid_spring_N_per_m(double Y_N_per_m, const EdgeCell&, bool shears);
double diagonal_spring_N_per_m(double Y_N_per_m, const EdgeCell&);
/// The spring of a structural or shear edge in a sheet of stiffness Y. Grid: a border edge gets half, because it
/// carries half the width. Mesh: Van Gelder's spring (see EdgeCell).
double spring_N_per_m(const Scene&, const struct Edge&, double Y_N_per_m);

/// Angle [rad] between neighbouring rows on the cylinder of a draped sheet. Requires drape_radius_m > du/2.
double drape_turn_rad(const Cloth&);
/// Position [m] of the middle of row `i` of a draped sheet that has slid by `offset_m` towards u1.
Vec3 draped_row(const Cloth&, int i, double offset_m);

/// Vertices of an edge in ascending order. The edges "u0" and "u1" run along v, "v0" and "v1" along u.
std::vector<std::uint32_t> edge_vertices(const Cloth&, const std::string& edge);
/// Vertices of the edge and of the neighbouring grid line. Holding both also fixes the direction at the edge.
std::vector<std::uint32_t> clamp_vertices(const Cloth&, const std::string& edge);

/// Triangles of the render and metric mesh, 3 indices each, 2 per cell, consistently wound (normal = axis_u x axis_v).
std::vector<std::array<std::uint32_t, 3>> triangles(const Cloth&);

/// Grid edges of one kind with their rest lengths, in a fixed order. All edges of a mesh are structural.
std::vector<Edge> edges(const Cloth&, EdgeKind);

/// Maximum frame-to-frame speed [m/s] of all colliders in the scene, measured at the ends of capsules and at a sample
/// of the vertices of skinned meshes. Jumps do not count. 0 if all colliders are static.
double collider_speed_m_per_s(const Scene&);

/// collider_speed_m_per_s without users' hands, whose speed a live session does not know in advance.
double scripted_collider_speed_m_per_s(const Scene&);

/// Maximum speed [m/s] of colliders and attached vertices since the previous frame, for each frame; the first is 0.
std::vector<double> driving_speeds_m_per_s(const Scene&);

/// Maximum frame-to-frame speed [m/s] of attached vertices until their release.
double grip_speed_m_per_s(const Scene&);

/// Maximum strain that hands impose: relative growth, since the start, of the distance between the first gripped vertex
/// and any other gripped vertex while both are attached. 0 if the hands are static or approach each other.
double grip_strain(const Scene&);

}  // namespace clothbench
