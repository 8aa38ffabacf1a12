// MuJoCo's flexes (cloth of triangular finite elements) behind clothbench_plugin.h.
#include <mujoco/mujoco.h>

#include <iomanip>
#include <sstream>

#include "peer.hpp"

static_assert(sizeof(mjtNum) == 8, "the adapter needs a MuJoCo in double precision, its default");

namespace clothbench::mujoco {
namespace {

using Model = std::unique_ptr<mjModel, void (*)(mjModel*)>;
using Spec = std::unique_ptr<mjSpec, void (*)(mjSpec*)>;

constexpr double kTimestep_s = 0.002;   // the engine's default
constexpr double kMeshRadius_m = 1e-5;  // triangles need a positive one
/// Y of an inextensible sheet. Constrained edges are softer: at their defaults, a hanging sheet has strains above 1.
constexpr double kInextensible_N_per_m = 1e4;
/// Inertia of an attached vertex over its mass, so large that forces hardly change its velocity within a step.
constexpr double kAttachedInertia = 1e6;

struct Settings {
  double contact, substeps, iterations, margin_m, frictionless;
  int steps(double dt_s) const {
    return static_cast<int>(std::max(1.0, substeps > 0 ? substeps : std::ceil(dt_s / kTimestep_s - 1e-9)));
  }
  /// Radius of the cloth [m]: half its thickness in self-collision, otherwise the scene's largest contact offset.
  double radius_m(const ClothbenchScene& s) const {
    if (peer::needs(s, CLOTHBENCH_SELF_COLLISION)) return s.self_thickness_m / 2;
    return std::max(kMeshRadius_m, peer::largest_margin(margin_m, s));
  }
  /// Contact offset [m]: the radius or, as a collider's margin adds to it, more. Passive contact ignores margins.
  double offset_m(const ClothbenchScene& s, std::uint32_t k) const {
    return contact > 0 ? radius_m(s) : std::max(radius_m(s), peer::margin(margin_m, s.colliders[k]));
  }
};

const ClothbenchSetting kSettings[] = {
    {"contact", "0: contact constraints; 1: passive contact, without friction", 0, 1},
    {"substeps", "time steps per frame; 0: as many as keep each at 2 ms or less", 0, 1},
    {"iterations", "maximum iterations of the constraint solver per step", 100, 1},
    {"collision_margin_m", "contact offset of all colliders; 0: the scene's margins", 0, 0},
    {"frictionless", "with contact=1: 1 runs scenes that need friction without it; 0 refuses them", 0, 1}};

[[noreturn]] void raise(const char* text) { throw std::runtime_error("MuJoCo: " + std::string(text)); }

/// An attribute of MJCF with exact numbers.
template <typename T>
std::string attr(const char* name, const T* values, std::size_t count) {
  std::ostringstream out;
  out << std::setprecision(17) << ' ' << name << "='";
  for (std::size_t k = 0; k < count; ++k) out << (k > 0 ? " " : "") << values[k];
  return out.str() + "'";
}
std::string attr(const char* name, double value) { return attr(name, &value, 1); }
std::string friction_of(double mu) { return attr("condim", mu > 0 ? 3 : 1) + attr("friction", mu); }

Spec parsed(const std::string& mjcf) {
  char error[1000] = "";
  Spec out(mj_parseXMLString(("<mujoco>" + mjcf + "</mujoco>").c_str(), nullptr, error, sizeof error), mj_deleteSpec);
  if (!out) raise(error);
  return out;
}

/// Adds a body per collider, as contacts are limited per pair of bodies, and a mocap body per capsule. A mesh is a
/// rigid flex, because the engine replaces mesh geoms by their convex hulls.
void add_collider(const ClothbenchCollider& c, const ClothbenchPose& pose, double margin_m, std::string& bodies,
                  std::string& flexes) {
  // The part with the higher priority decides the friction. The types exclude pairs of colliders.
  const std::string contact = " contype='0' priority='1'" + attr("margin", margin_m) + friction_of(c.friction);
  for (const double* n = pose.capsules; n < pose.capsules + 7 * c.capsule_count; n += 7) {
    const double size[] = {n[6], std::max(peer::length(peer::point(n, 1) - peer::point(n, 0)) / 2, 1e-9)};
    bodies += "<body mocap='true'><geom type='capsule'" + attr("size", size, 2) + contact + "/></body>";
  }
  std::string fixed;
  if (c.shape == CLOTHBENCH_SHAPE_SPHERE) fixed = "sphere'" + attr("size", c.radius_m);
  if (c.shape == CLOTHBENCH_SHAPE_PLANE) fixed = "plane' size='0 0 1'" + attr("zaxis", c.normal, 3);  // endless
  if (c.shape == CLOTHBENCH_SHAPE_BOX) fixed = "box'" + attr("size", c.half_extent_m, 3) + attr("xyaxes", c.axes, 6);
  if (!fixed.empty()) bodies += "<body><geom type='" + fixed + attr("pos", c.center_m, 3) + contact + "/></body>";
  if (c.shape != CLOTHBENCH_SHAPE_MESH) return;
  const std::string name = "m" + std::to_string(flexes.size());
  bodies += "<body name='" + name + "'/>";
  flexes += "<flex body='" + name + "'" + attr("radius", kMeshRadius_m) +
            attr("vertex", pose.vertices_m, 3 * c.vertex_count) + attr("element", c.triangles, 3 * c.triangle_count) +
            "><contact" + contact + "/></flex>";
}

/// The first flex is the cloth; meshes follow. Elements have Lame's constants E t / (8 (1 + nu)) and E t nu / (2 (1 +
/// nu) (1 - 2 nu)) [N/m]; strips of a grid bend with B = E t^3 / (20 (1 + nu)).
Model model(const Settings& settings, const ClothbenchScene& s) {
  mju_user_error = raise;                 // the default ends the process
  mju_user_warning = [](const char*) {};  // the default writes a file
  const std::vector<double> inverse_mass = peer::inverse_masses(s);
  std::vector<std::string> blocks;  // of bodies, because MuJoCo adds a body in a time that grows with their number
  std::string names;
  for (std::uint32_t v = 0; v < s.vertex_count; ++v) {
    const double mass = s.mass_kg[v], inertia[] = {1e-4 * mass, 1e-4 * mass, 1e-4 * mass};
    const std::string name = "v" + std::to_string(v), damping = attr("damping", s.damping_per_s * mass);
    if (v % 256 == 0) blocks.emplace_back();
    names += name + " ";
    blocks.back() += "<body name='" + name + "'" + attr("pos", s.rest_position_m + 3 * v, 3) +
                     "><inertial pos='0 0 0'" + attr("mass", mass) + attr("diaginertia", inertia, 3) + "/>";
    for (const char* axis : {"1 0 0", "0 1 0", "0 0 1"})
      if (inverse_mass[v] > 0) blocks.back() += std::string("<joint type='slide' axis='") + axis + "'" + damping + "/>";
    blocks.back() += "</body>";
  }
  const bool self = peer::needs(s, CLOTHBENCH_SELF_COLLISION), contact = self || s.collider_count > 0;
  const double radius = settings.radius_m(s), b = peer::needs(s, CLOTHBENCH_BEND) ? s.bending_rigidity_N_m : 0;
  const double y = s.structural_count > 0 ? s.structural_edges[0].membrane_stiffness_N_per_m : 0;
  const double e_t = 3.5 * (std::isinf(y) ? kInextensible_N_per_m : y);
  const double thickness = b > 0 ? std::sqrt((20 + 20.0 / 6) * b / e_t) : 1e-3;
  std::string flexes = "<flex body='" + names + "'" + attr("element", s.triangles, 3 * s.triangle_count) +
                       attr("radius", radius) + "><contact" + friction_of(s.self_friction) +
                       (settings.contact > 0 ? " passive='true'" : "") + (self ? "" : " selfcollide='none'") +
                       "/><elasticity" + attr("poisson", 1.0 / 6) + attr("thickness", thickness) +
                       attr("young", e_t / thickness) + " elastic2d='" + (b > 0 ? "both" : "stretch") + "'/></flex>";
  blocks.emplace_back();
  for (std::uint32_t k = 0; k < s.collider_count; ++k)
    add_collider(s.colliders[k], s.poses[k], settings.offset_m(s, k) - radius, blocks.back(), flexes);
  // A flex's stiffness is implicit only with this integrator and solver, which passive contact requires.
  const Spec spec =
      parsed("<option integrator='implicitfast' solver='CG'" + attr("iterations", settings.iterations) +
             attr("gravity", s.gravity_m_per_s2, 3) + "><flag autoreset='disable'" +
             (contact ? "" : " contact='disable'") + "/></option><deformable>" + flexes + "</deformable>");
  for (const std::string& block : blocks)
    mjs_attach(mjs_findBody(spec.get(), "world")->element, parsed("<worldbody>" + block + "</worldbody>")->element, "",
               "");
  const double n = s.vertex_count + 1000.0;  // the engine reserves room for all pairs of bodies
  spec->memory = static_cast<mjtSize>(256e6 + 2e4 * n + (contact ? 2 * n * n : 0));
  Model out(mj_compile(spec.get(), nullptr), mj_deleteModel);
  if (!out) raise(mjs_getError(spec.get()));
  return out;
}

class Solver : public peer::Adapter<Settings, (peer::kSupports & ~CLOTHBENCH_REGIONS) | CLOTHBENCH_SELF_COLLISION> {
 public:
  Solver(const Settings& given, const ClothbenchScene& s)
      : Adapter("step", given, s), model_(model(given, s)), data_(mj_makeData(model_.get()), mj_deleteData) {
    restart(peer::start_of(s));
  }

  static std::string obstacle(const Settings& settings, const ClothbenchScene& s) {
    if (mj_version() != mjVERSION_HEADER) return "the adapter was built for another version of MuJoCo";
    if (settings.contact > 1) return "setting contact: expected 0 (constraints) or 1 (passive)";
    if (s.vertex_count > 60000) return "MuJoCo numbers bodies with 16 bits, so a cloth has at most 60000 vertices";
    if (settings.contact > 0 && peer::needs(s, CLOTHBENCH_FRICTION) && !(settings.frictionless > 0))
      return "MuJoCo's passive contact has no friction (solver.frictionless=1 runs it without)";
    return "";
  }

  /// The coordinates are displacements from the sheet at rest; a pinned vertex has none, and its body is moved.
  void restart(const ClothbenchRestart& start) {
    mj_resetData(model_.get(), data_.get());
    for (std::uint32_t v = 0; v < scene.vertex_count; ++v) {
      if (!free(v)) std::copy_n(scene.position_m + 3 * v, 3, model_->body_pos + 3 * (v + 1));
      if (!free(v)) continue;
      const peer::Point x = peer::point(start.position_m, v) - peer::point(scene.rest_position_m, v);
      std::copy_n(x.data(), 3, data_->qpos + dof(v));
      std::copy_n(start.velocity_m_per_s + 3 * v, 3, data_->qvel + dof(v));
    }
  }

  std::int32_t step(const ClothbenchFrame& frame) try {
    const int n = settings.steps(frame.dt_s);
    model_->opt.timestep = frame.dt_s / n;
    std::vector<peer::Point> from;
    for (std::uint32_t k = 0; k < scene.grip_count; ++k) from.push_back(position(scene.grips[k]));
    for (int k = 0; k < n; ++k) {
      move_grips(frame, from, static_cast<double>(k) / n);
      move_colliders(frame, static_cast<double>(k + 1) / n);
      mj_step(model_.get(), data_.get());
      for (const int bad : {mjWARN_BADQPOS, mjWARN_BADQVEL, mjWARN_BADQACC})
        if (data_->warning[bad].number > 0) return CLOTHBENCH_DIVERGED;
    }
    move_grips(frame, from, 1);
    return CLOTHBENCH_OK;
  } catch (const std::exception&) {
    return CLOTHBENCH_DIVERGED;
  }

  void read(double* position_m, double* velocity_m_per_s) const {
    for (std::uint32_t v = 0; v < scene.vertex_count; ++v) {
      std::copy_n(position(v).data(), 3, position_m + 3 * v);
      std::copy_n((free(v) ? peer::point(data_->qvel + dof(v), 0) : peer::Point{}).data(), 3, velocity_m_per_s + 3 * v);
    }
  }

  double margin_m(std::uint32_t collider) const { return settings.offset_m(scene, collider); }
  static double next_velocity(double velocity, double h, double gravity, double damping) {
    return velocity + h * (gravity - damping * velocity);
  }

 private:
  /// First of a vertex's three coordinates in qpos and qvel, as all joints slide; negative if it is pinned.
  int dof(std::uint32_t v) const { return model_->body_dofadr[v + 1]; }  // body 0 is the world
  bool free(std::uint32_t v) const { return dof(v) >= 0; }
  peer::Point position(std::uint32_t v) const {
    if (!free(v)) return peer::point(scene.position_m, v);
    return peer::point(scene.rest_position_m, v) + peer::point(data_->qpos + dof(v), 0);
  }

  /// Puts colliders at the share `part` of their way in the frame, or at its end if they teleport.
  void move_colliders(const ClothbenchFrame& frame, double part) {
    int mocap = 0, flex = 1;
    for (std::uint32_t k = 0; k < scene.collider_count; ++k) {
      const ClothbenchCollider& c = scene.colliders[k];
      const ClothbenchPose &before = frame.poses_before[k], &now = frame.poses[k];
      const double share = peer::teleports(frame.collider_teleports, k) ? 1 : part;
      for (std::uint32_t n = 0; n < c.capsule_count; ++n, ++mocap) {
        const peer::Point a = peer::between(before.capsules + 7 * n, now.capsules + 7 * n, share);
        const peer::Point b = peer::between(before.capsules + 7 * n + 3, now.capsules + 7 * n + 3, share);
        const peer::Point axis = b - a, middle = 0.5 * (a + b);
        std::copy_n(middle.data(), 3, data_->mocap_pos + 3 * mocap);
        if (peer::length(axis) > 0) mju_quatZ2Vec(data_->mocap_quat + 4 * mocap, axis.data());
      }
      if (c.shape != CLOTHBENCH_SHAPE_MESH) continue;
      mjtNum* vertices = model_->flex_vert + 3 * model_->flex_vertadr[flex++];
      for (std::uint32_t v = 0; c.moves != 0 && v < 3 * c.vertex_count; v += 3)
        std::copy_n(peer::between(before.vertices_m + v, now.vertices_m + v, share).data(), 3, vertices + v);
    }
  }

  /// Sets the inertia of grips' vertices, and position (at the share `part` of the frame) and velocity of attached
  /// ones.
  void move_grips(const ClothbenchFrame& frame, const std::vector<peer::Point>& from, double part) {
    for (std::uint32_t k = 0; k < scene.grip_count; ++k) {
      const std::uint32_t v = scene.grips[k];
      if (!free(v)) continue;  // it is also pinned
      const double mass = scene.mass_kg[v] * (frame.grip_held[k] != 0 ? kAttachedInertia : 1);
      std::fill_n(model_->dof_armature + dof(v), 3, mass - scene.mass_kg[v]);
      std::fill_n(model_->dof_M0 + dof(v), 3, mass);
      if (frame.grip_held[k] == 0) continue;
      const peer::Point to = peer::point(frame.grip_position_m, k);
      const peer::Point way = peer::teleports(frame.grip_teleports, k) ? peer::Point{} : to - from[k];
      const peer::Point at = to - (1 - part) * way - peer::point(scene.rest_position_m, v);
      std::copy_n(at.data(), 3, data_->qpos + dof(v));
      std::copy_n(((1 / frame.dt_s) * way).data(), 3, data_->qvel + dof(v));
    }
  }

  Model model_;
  std::unique_ptr<mjData, void (*)(mjData*)> data_;
};

}  // namespace
}  // namespace clothbench::mujoco

CLOTHBENCH_PEER(clothbench::mujoco, "mujoco", "MuJoCo", "float64", "MuJoCo's flexes on one CPU core")
