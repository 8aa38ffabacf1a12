// MuJoCo's flexes (cloth of triangular finite elements) behind clothbench_plugin.h.
#include "mujoco/model.hpp"

namespace clothbench::mujoco {
namespace {

constexpr std::uint32_t kSupports = (peer::kSupports & ~CLOTHBENCH_REGIONS) | CLOTHBENCH_SELF_COLLISION;
/// Inertia of an attached vertex over its mass, so large that forces hardly change its velocity within a step.
constexpr double kAttachedInertia = 1e6;

class Solver : public peer::Adapter {
 public:
  Solver(const Settings& settings, const ClothbenchScene& s)
      : Adapter("step", s, kSupports),
        settings_(settings),
        inverse_mass_(peer::inverse_masses(s)),
        model_(model(settings, s, inverse_mass_)) {
    counts = {{"contacts", "contacts, maximum over the frame's steps", 0},
              {"pairs_full", "pairs of bodies with the engine's maximum of contacts, which drops others", 0},
              {"iterations", "iterations of the constraint solver, all steps of the frame", 0},
              {"unconverged", "steps in which the implicit elasticity reached the limit of iterations", 0}};
    data_.reset(mj_makeData(model_.get()));
    for (std::uint32_t v = 0; v < s.vertex_count; ++v)
      for (int k = 0; k < 3 && free(v); ++k) model_->dof_damping[dof(v) + k] = s.damping_per_s * s.mass_kg[v];
    restart(peer::start_of(s));
  }

  /// The coordinates are displacements from the sheet at rest; a pinned vertex has none, and its body is moved.
  void restart(const ClothbenchRestart& start) {
    mj_resetData(model_.get(), data_.get());
    for (std::uint32_t k = 0; k < 3 * scene.vertex_count; ++k) {
      const std::uint32_t v = k / 3, axis = k % 3;
      if (free(v)) {
        data_->qpos[dof(v) + axis] = start.position_m[k] - scene.rest_position_m[k];
        data_->qvel[dof(v) + axis] = start.velocity_m_per_s[k];
      } else {
        model_->body_pos[3 * body(v) + axis] = scene.position_m[k];
      }
    }
    for (ClothbenchCount& c : counts) c.value = 0;
  }

  std::int32_t step(const ClothbenchFrame& frame) try {
    const int n = settings_.steps(frame.dt_s);
    model_->opt.timestep = frame.dt_s / n;
    const std::vector<Point> from = attach(frame);
    for (ClothbenchCount& c : counts) c.value = 0;
    data_->warning[mjWARN_INERTIA].number = 0;
    for (int k = 0; k < n; ++k) {
      move_grips(frame, from, static_cast<double>(k) / n);
      move_colliders(frame, static_cast<double>(k + 1) / n);
      mj_step(model_.get(), data_.get());
      for (const int bad : {mjWARN_BADQPOS, mjWARN_BADQVEL, mjWARN_BADQACC})
        if (data_->warning[bad].number > 0) return CLOTHBENCH_DIVERGED;
      count();
    }
    move_grips(frame, from, 1);
    return CLOTHBENCH_OK;
  } catch (const std::exception&) {
    return CLOTHBENCH_DIVERGED;
  }

  void read(double* position_m, double* velocity_m_per_s) const {
    for (std::uint32_t k = 0; k < 3 * scene.vertex_count; ++k) {
      const std::uint32_t v = k / 3, axis = k % 3;
      position_m[k] = free(v) ? scene.rest_position_m[k] + data_->qpos[dof(v) + axis] : scene.position_m[k];
      velocity_m_per_s[k] = free(v) ? data_->qvel[dof(v) + axis] : 0;
    }
  }

  double margin_m(std::uint32_t collider) const { return offset_m(settings_, scene, collider); }

 private:
  static int body(std::uint32_t v) { return static_cast<int>(v) + 1; }  // body 0 is the world
  bool free(std::uint32_t v) const { return inverse_mass_[v] > 0; }
  /// First of a free vertex's three coordinates. All joints slide, so that it is the index of qpos and of qvel.
  int dof(std::uint32_t v) const { return model_->body_dofadr[body(v)]; }

  /// Puts colliders at the share `part` of their way in the frame, or at its end if they teleport.
  void move_colliders(const ClothbenchFrame& frame, double part) {
    int mocap = 0;
    for (std::uint32_t k = 0; k < scene.collider_count; ++k) {
      const ClothbenchCollider& c = scene.colliders[k];
      const double share = frame.collider_teleports != nullptr && frame.collider_teleports[k] != 0 ? 1 : part;
      const auto between = [&](const double* a, const double* b, std::size_t i) {
        return a[i] + share * (b[i] - a[i]);
      };
      for (std::uint32_t n = 0; n < c.capsule_count; ++n, ++mocap) {
        double ends[6];
        for (std::size_t i = 0; i < 6; ++i)
          ends[i] = between(frame.poses_before[k].capsules, frame.poses[k].capsules, 7 * n + i);
        const Point a = peer::point(ends, 0), b = peer::point(ends, 1), axis = b - a, middle = 0.5 * (a + b);
        std::copy_n(middle.data(), 3, data_->mocap_pos + 3 * mocap);
        if (peer::length(axis) > 0) mju_quatZ2Vec(data_->mocap_quat + 4 * mocap, axis.data());
      }
      if (c.shape != CLOTHBENCH_SHAPE_MESH || c.moves == 0) continue;
      const int flex = mj_name2id(model_.get(), mjOBJ_FLEX, name("m", k).c_str());
      mjtNum* vertices = model_->flex_vert + 3 * model_->flex_vertadr[flex];
      for (std::size_t i = 0; i < 3 * std::size_t{c.vertex_count}; ++i)
        vertices[i] = between(frame.poses_before[k].vertices_m, frame.poses[k].vertices_m, i);
    }
  }

  /// Whether grip `k` moves its vertex, which may also be pinned.
  bool held(const ClothbenchFrame& frame, std::uint32_t k) const {
    return free(scene.grips[k]) && (frame.grip_held == nullptr || frame.grip_held[k] != 0);
  }

  /// Gives attached vertices their inertia and released ones their mass. Returns the position of each.
  std::vector<Point> attach(const ClothbenchFrame& frame) {
    std::vector<Point> out;
    for (std::uint32_t k = 0; k < scene.grip_count; ++k) {
      const std::uint32_t v = scene.grips[k];
      const double mass = scene.mass_kg[v] * (held(frame, k) ? kAttachedInertia : 1);
      out.push_back(peer::point(scene.rest_position_m, v) + (free(v) ? peer::point(data_->qpos + dof(v), 0) : Point{}));
      for (int i = 0; i < 3 && free(v); ++i) {
        model_->dof_armature[dof(v) + i] = mass - scene.mass_kg[v];
        model_->dof_M0[dof(v) + i] = mass;
      }
    }
    return out;
  }

  /// Sets position and velocity of attached vertices at the share `part` of the frame.
  void move_grips(const ClothbenchFrame& frame, const std::vector<Point>& from, double part) {
    for (std::uint32_t k = 0; k < scene.grip_count; ++k) {
      const std::uint32_t v = scene.grips[k];
      if (!held(frame, k)) continue;
      const bool jumps = frame.grip_teleports != nullptr && frame.grip_teleports[k] != 0;
      const Point to =
          frame.grip_position_m != nullptr ? peer::point(frame.grip_position_m, k) : peer::point(scene.position_m, v);
      const Point way = jumps ? Point{} : to - from[k], velocity = (1 / frame.dt_s) * way;
      const Point at = to - (1 - part) * way - peer::point(scene.rest_position_m, v);
      std::copy_n(at.data(), 3, data_->qpos + dof(v));
      std::copy_n(velocity.data(), 3, data_->qvel + dof(v));
    }
  }

  /// Contacts of a pair beyond mjMAXCONPAIR leave no trace in the engine, so that only full pairs can be counted. The
  /// cloth with itself is one pair.
  void count() {
    std::map<std::pair<int, int>, int> pairs;
    for (int i = 0; i < data_->ncon; ++i) ++pairs[{data_->contact[i].geom[0], data_->contact[i].flex[0]}];
    const auto full = std::count_if(pairs.begin(), pairs.end(), [](auto& p) { return p.second >= mjMAXCONPAIR; });
    counts[0].value = std::max(counts[0].value, static_cast<double>(data_->ncon));
    counts[1].value = std::max(counts[1].value, static_cast<double>(full));
    for (int i = 0; i < std::min(mjNISLAND, std::max(1, data_->nisland)); ++i)
      counts[2].value += data_->solver_niter[i];
    counts[3].value = data_->warning[mjWARN_INERTIA].number;
  }

  Settings settings_;
  std::vector<double> inverse_mass_;  ///< [1/kg], 0 where pinned
  Model model_;
  std::unique_ptr<mjData, void (*)(mjData*)> data_{nullptr, mj_deleteData};
};

/// The engine's integrator: v += h (g - c v), x += h v.
double free_fall_m(const double* values, double dt_s, double gravity, double velocity, double damping,
                   std::int32_t frames) {
  const int n = Settings(values).steps(dt_s);
  const double h = dt_s / n;
  return peer::fallen_m(std::int64_t{frames} * n, h, velocity,
                        [=](double v) { return v + h * (gravity - damping * v); });
}

const ClothbenchSetting kSettings[] = {
    {"contact", "0: contact constraints; 1: passive contact, without friction", 0, 1},
    {"substeps", "time steps per frame, instead of timestep_s; 0: by timestep_s", 0, 1},
    {"iterations", "maximum iterations of the constraint solver per step", 100, 1},
    {"timestep_s", "largest time step", 0.002, 0},
    {"collision_margin_m", "contact offset of all colliders; 0: the scene's margins", 0, 0},
    {"frictionless",
     "with contact=1, which has no friction: 1 runs scenes that need friction without it; 0 refuses them", 0, 1},
    {"nominal", "1: Young's modulus and thickness by the formulas of an elastic plate; 0: fitted to MuJoCo's elements",
     0, 1}};

}  // namespace
}  // namespace clothbench::mujoco

CLOTHBENCH_PEER(clothbench::mujoco, "mujoco", "MuJoCo", "float64", "MuJoCo's flexes on one CPU core")
