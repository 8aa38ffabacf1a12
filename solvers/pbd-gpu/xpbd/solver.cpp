// XPBD in small steps (Macklin, Müller & Chentanez 2016; Macklin et al. 2019) with a direct solve of every grid line.
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <utility>

#include "common/gpu_solver.hpp"
#include "xpbd/constraints.hpp"
#include "xpbd/contact/contact.hpp"
#include "xpbd/fused/fused_frame.hpp"
#include "xpbd/lines/grid_lines.hpp"
#include "xpbd/mesh/chains.hpp"
#include "xpbd/mesh/matrices.hpp"
#include "xpbd/time/integrator.hpp"
#include "xpbd/time/rules.hpp"

namespace clothbench::pbd_gpu {
namespace {

class Xpbd final : public GpuSolver {
 public:
  using GpuSolver::GpuSolver;

  std::vector<SolverCount> counts() const override {
    if (!contact_) return {};
    const ContactDiagnostics f = contact_->diagnostics();
    return {{"contact_infeasible", "vertices without a feasible position", static_cast<double>(f.infeasible_vertices)},
            {"contact_inside", "pairs that touch at a substep's start", static_cast<double>(f.inside)},
            {"contact_overflow", "candidate pairs beyond the list's capacity", static_cast<double>(f.overflow),
             "contact: candidate pairs beyond the list's capacity, which solver.tuning.contact_pairs sets"}};
  }

  /// A frame is repeated if a link is strained too far, with more substeps, or if pairs do not fit their lists, with
  /// longer ones, if the device has room for them.
  StepStatus step(const FrameInput& frame) override {
    const ContactDiagnostics before = contact_ ? contact_->diagnostics() : ContactDiagnostics{};
    repeated_.clear();
    StepStatus status = GpuSolver::step(frame);
    while (status == StepStatus::Ok && !saved_.empty()) {
      const bool grows = can_grow_ && growth_ < kMaxGrowth && contact_->diagnostics().overflow > before.overflow;
      measured_ = contact_->read_measured();
      if (!grows && !controller_.repeats(measured_.strain)) break;
      repeated_.push_back(GpuSolver::last_cost());
      const std::uint32_t growth = grows ? 2 * growth_ : growth_;
      status = grows ? return_to_start(growth, before) : go_back(before);
      if (growth_ < growth) break;
      repeats_ = !grows;
      if (status == StepStatus::Ok) status = run_frame(frame.dt_s);
      repeats_ = false;
    }
    return status;
  }

  /// All attempts of the last frame.
  FrameCost last_cost() const override {
    FrameCost all = GpuSolver::last_cost();
    const auto add = [](std::vector<double>& to, const std::vector<double>& more) {
      for (std::size_t k = 0; k < std::min(to.size(), more.size()); ++k) to[k] += more[k];
    };
    for (const FrameCost& one : repeated_) {
      all.device_s += one.device_s;
      add(all.stage_device_s, one.stage_device_s);
      add(all.stage_read_B, one.stage_read_B);
      add(all.stage_write_B, one.stage_write_B);
    }
    return all;
  }

  void reset() override {
    if (growth_ > 1 && !grows_) {  // so that every run after a reset takes the same course
      growth_ = 1;
      load(scene());
      return;
    }
    GpuSolver::reset();
    if (contact_) contact_->set_diagnostics({});
    measured_ = {};
    last_dt_s_ = last_h_s_ = 0;
    controller_.reset();
  }

 private:
  void build() override {
    if (device_->shuffled_lanes() == 0)
      throw Error(
          "solver xpbd: this device lacks subgroup shuffle, vote or ballot in compute shaders (optional in Vulkan "
          "1.1)");
    const bool chained = needs_chain_solver(scene());
    if (chained && scene().needs.has(Feature::Bend) && !scene().cloth.mesh)
      throw Error(
          "solver xpbd: bending is supported on triangle meshes and even grids, and this cloth is neither; expected "
          "bending_rigidity_N_m 0");
    const FeatureDecision membrane = membrane_decision(scene(), settings());
    crumpled_ = starts_crumpled(scene());
    std::vector<double> start = initial_positions(scene());
    const bool touches = !is_contact_free(scene());
    if (const int wanted = uncapped_substeps_if_capped(scene(), settings()); wanted > 0)
      disable(std::to_string(wanted) + " substeps",
              "the colliders are fast: " + std::to_string(xpbd_substeps(scene(), settings())) +
                  " are the maximum per frame; the cloth is overstretched for some frames");
    const ChainCloth cloth = chained ? chain_cloth(scene()) : ChainCloth{};
    if (!cloth.welded.empty() && scene().needs.has(Feature::Bend))
      throw Error(
          fmt::format("solver xpbd: /cloth/mesh: vertex {} is on an edge shorter than 1/50 of the mean; expected none "
                      "in a cloth with bending",
                      cloth.welded.front()));
    const std::vector<float> w = welded(inverse_masses(scene()), cloth);
    if (crumpled_) break_symmetry(scene(), w, start);
    const Vec3 origin = scene().cloth.center_m;
    add_state(start, w, origin, 1);
    const std::uint64_t bytes = position_buffer().bytes();
    const vulkan::Buffer& rounding_x = add_buffer(BIND_POSITION_COMPENSATION, "position compensation", bytes);
    const vulkan::Buffer& rounding_v = add_buffer(BIND_VELOCITY_COMPENSATION, "velocity compensation", bytes);
    if (touches) add_colliders(origin, true);
    add_grips(origin, 1);
    add_history();
    const FeatureDecision tension = tension_decision(scene(), settings());
    if (!tension.enabled) disable("implicit tension", tension.reason);
    if (!membrane.enabled && scene().cloth.mesh && scene().material.membrane_stiffness_N_per_m)
      disable("triangles of constant strain",
              membrane.reason + ": springs along edges take their place, and the sheet is softer than Y implies",
              "sheet_Y");
    const FeatureDecision splitting_correction = splitting_correction_decision(scene(), settings());
    const bool soft = scene().material.membrane_stiffness_N_per_m && scene().needs.has(Feature::Shear);
    if (!splitting_correction.enabled)
      disable("splitting correction", splitting_correction.reason, soft ? "sheet_Y" : "");
    second_solve_ = touches && chained;
    if (touches)
      contact_ =
          std::make_unique<XpbdContact>(frame(), scene(), origin, colliders(), cloth.particle, second_solve_, growth_);
    if (chained)
      chains_ = std::make_unique<Chains>(frame(), scene(), cloth, uses_bdf2_, tension.enabled, membrane.enabled);
    else
      lines_ = std::make_unique<Lines>(frame(), scene(), uses_bdf2_, tension.enabled, splitting_correction.enabled);
    if (touches && lines_) fused_frame_ = FusedFrame::make(frame(), *lines_, *contact_);
    if (lines_ && !fused_frame_) lines_->add_kernels(touches);
    if (touches && !fused_frame_) contact_->add_kernels();
    // Crumpled starts need all substeps to come to rest. Cloth that attachments have released would snap if the number
    // of substeps changed. Capsules seldom strain links too far, and copying the state would lengthen their short
    // frames.
    const bool adapts = touches && !scene().needs.has(Feature::Capsules) && grips() == nullptr && !crumpled_ &&
                        settings()["substeps"] == 0;
    controller_ = SubstepController(scene(), settings(), adapts);
    if (adapts) contact_->add_measurement(cloth.particle);
    lists_ = 1;
    start_h_s_ = 0;
    if (fused_frame_) contact_free_substeps_ = contact_free_substeps(scene(), settings());
    plan_.substeps = in_frames(controller_.max_substeps(), scene().time.dt());
    saved_.clear();
    can_grow_ = contact_ && contact_->with_itself() && scene().motion.empty();
    if (adapts || can_grow_) {
      std::vector<const vulkan::Buffer*> state = {&position_buffer(), &velocity_buffer(), &rounding_x, &rounding_v,
                                                  &contact_->frame_state()};
      if (scene().needs.has(Feature::MovingMesh)) state.push_back(colliders()->kinematic_meshes.positions);
      for (const vulkan::Buffer* b : state)
        saved_.emplace_back(b, &add_buffer(kUnbound, b->name() + " at the start", b->bytes()));
    }
    reads_back_ = !saved_.empty();
    if (grips() != nullptr && !fused_frame_ && !(lines_ && lines_->moves_grips()))
      move_grips_ = grips()->add_kernel(position_buffer());
    if (const FeatureSet near = scene().needs & kColliderFeatures; !touches && !near.empty()) {
      add_stage("ContactSubstep", near | (scene().needs & FeatureSet{Feature::Friction, Feature::DoubleSided}));
      disable("contact", "no collider is in reach of the cloth");
    }
  }

  /// Sets the state to the frame's start, and the diagnostics.
  StepStatus go_back(const ContactDiagnostics& diagnostics) {
    vulkan::Program back(device_);
    for (const auto& [buffer, saved] : saved_) back.copy(0, *saved, *buffer);
    back.record(false);
    contact_->set_diagnostics(diagnostics);
    return run(back);
  }

  /// Sets the state to the frame's start, lists of pairs to `growth` times their first size, and the diagnostics. If
  /// the device has no room, lists and diagnostics stay: the frame is lost, and its overflow ends the run.
  StepStatus return_to_start(std::uint32_t growth, ContactDiagnostics diagnostics) {
    const ContactDiagnostics overflowed = contact_->diagnostics();
    if (const StepStatus status = go_back(diagnostics); status != StepStatus::Ok) return status;
    ClothState start;
    read_state(start);
    grows_ = true;
    const std::uint32_t last = std::exchange(growth_, growth);
    try {
      load(scene());
    } catch (const Error&) {
      growth_ = last;
      diagnostics = overflowed;
      load(scene());
    }
    const bool restarted = restart(start);
    grows_ = false;
    contact_->set_diagnostics(diagnostics);
    return restarted ? StepStatus::Ok : StepStatus::DeviceLost;
  }

  /// History of BDF2: the state before the last substep.
  void add_history() {
    const FeatureDecision prediction = bdf2_decision(scene(), settings());
    uses_bdf2_ = prediction.enabled;
    if (!uses_bdf2_) {
      disable("bdf2", prediction.reason);
      return;
    }
    add_buffer(BIND_LAST_POSITIONS, "last positions", position_buffer().bytes());
    add_buffer(BIND_LAST_VELOCITIES, "last velocities", position_buffer().bytes());
  }

  /// Inverse masses of particles. The masses of welded vertices are added; if one of them is held, the particle is.
  static std::vector<float> welded(std::vector<float> w, const ChainCloth& cloth) {
    for (const std::uint32_t v : cloth.welded) {
      float& of = w[cloth.particle[v]];
      of = of > 0 && w[v] > 0 ? 1 / (1 / of + 1 / w[v]) : 0;
    }
    for (const std::uint32_t v : cloth.welded) w[v] = w[cloth.particle[v]];
    return w;
  }

  int substeps_in(double dt_s) const { return in_frames(controller_.substeps(), dt_s); }

  /// Substeps of a frame of dt_s, if a frame of the scene's duration has `by_rule`.
  int in_frames(int by_rule, double dt_s) const {
    return by_rule * frames_in(dt_s) * (crumpled_ && settings()["substeps"] == 0 ? rules::kCrumpledFactor : 1);
  }

  /// Steps of a contact-free frame; `most`: its substeps if it has contact.
  FusedFrame::Steps contact_free_steps(double dt_s, int most) const {
    const int substeps = std::min(most, in_frames(contact_free_substeps_, dt_s));
    return {substeps, time_step(uses_bdf2_, dt_s / substeps, 0, scene().material.damping_per_s)};
  }

  void update_substep_count(double dt_s) override {
    if (!controller_.adapts()) return;
    if (repeats_) {
      last_h_s_ = start_h_s_;
    } else {
      const double frame_s = scene().time.dt(), max_displacement_m = measured_.displacement_m * lists_;
      // Before the first frame no displacement is known.
      const double cloth_m =
          last_dt_s_ > 0 ? max_displacement_m * frame_s / last_dt_s_ : std::numeric_limits<double>::infinity();
      last_dt_s_ = dt_s;
      controller_.next(cloth_m, measured_.strain);
      lists_ = lists_in(dt_s);
    }
    start_h_s_ = std::exchange(last_h_s_, length_of(dt_s));
  }

  /// Fused frames keep the last length on the device, because contact-free frames have another number of substeps.
  std::vector<double> frame_key() const override {
    return {static_cast<double>(controller_.substeps()), static_cast<double>(lists_), fused_frame_ ? 0 : start_h_s_};
  }

  TimeStep time_step_after(double last_h_s, double dt_s) const {
    return time_step(uses_bdf2_, length_of(dt_s), last_h_s, scene().material.damping_per_s);
  }
  /// Length [s] of a substep in a frame of dt_s; 0 for 0.
  double length_of(double dt_s) const { return dt_s > 0 ? dt_s / substeps_in(dt_s) : 0; }

  /// Records substeps [first, first + count) in as few dispatches as the kernels allow.
  void record_lines(int first, int count, int substeps, double dt_s, const TimeStep& step) {
    if (count == 0) return;
    if (lines_)
      lines_->record(first, count, substeps, dt_s, step);
    else
      chains_->record(count, step);
  }

  void record_frame(double dt_s, double last_dt_s) override {
    const int substeps = substeps_in(dt_s);
    // The first substep differs if the last frame's substeps had a different length, or if there was no last frame.
    const TimeStep start = time_step_after(uses_bdf2_ ? length_of(last_dt_s) : start_h_s_, dt_s),
                   step = time_step_after(length_of(dt_s), dt_s);
    for (const auto& [buffer, saved] : saved_) copy(0, *buffer, *saved);
    if (colliders() != nullptr) colliders()->record();
    if (grips() != nullptr) grips()->record_upload();
    if (contact_) contact_->record_shapes(dt_s, substeps);
    if ((lines_ ? lines_->is_single_dispatch() : chains_->is_single_dispatch()) && !contact_) {
      const int apart = uses_bdf2_ && last_dt_s != dt_s ? 1 : 0;
      record_lines(0, apart, substeps, dt_s, start);
      record_lines(apart, substeps - apart, substeps, dt_s, step);
      return;
    }
    for (int list = 0, lists = lists_in(dt_s); list < lists; ++list) {
      // Contact treats the substeps of each list as a frame.
      const int first = substeps * list / lists, count = substeps * (list + 1) / lists - first;
      const double list_s = dt_s * (static_cast<double>(count) / substeps);
      if (fused_frame_) {
        fused_frame_->record(list_s, {count, step}, contact_free_steps(list_s, count));
        if (controller_.adapts()) contact_->record_measurement();
        continue;
      }
      if (contact_) contact_->record_list(list_s, count);
      for (int s = first; s < first + count; ++s) {
        // Before the solve, as in the fused frame, so that a released vertex moves freely in this substep.
        if (move_grips_ != nullptr) grips()->record_move(*move_grips_, (s + 1.0) / substeps, dt_s);
        if (contact_) contact_->record_before(s - first, count, list_s);
        record_lines(s, 1, substeps, dt_s, s == 0 ? start : step);
        if (contact_)
          contact_->record_after(s - first, count, list_s, [&] {
            if (second_solve_) chains_->record(1, step, true);
          });
        if (contact_ && chains_) chains_->record_welds();
      }
      if (controller_.adapts()) contact_->record_measurement();
    }
  }

  /// Number of lists of pairs that a frame builds, one after another. It is 1 with kinematic shapes or attachments,
  /// whose displacements are known only for the whole frame.
  int lists_in(double dt_s) const {
    if (!contact_ || contact_->has_kinematic_shapes() || !scene().grips.vertices.empty()) return 1;
    return controller_.lists() * frames_in(dt_s);
  }

  /// Number of the scene's frames that a frame of dt_s counts as: a hitch has the substeps of several frames.
  int frames_in(double dt_s) const {
    const double frame = scene().time.dt();
    if (!(dt_s > rules::kLongFrame * frame)) return 1;
    return static_cast<int>(std::ceil(std::min(dt_s, std::max(rules::kMaxLongFrame_s, frame)) / frame - 1e-9));
  }

  SubstepController controller_;
  int lists_ = 1, contact_free_substeps_ = 0;
  double last_dt_s_ = 0;                 ///< duration of the last frame; 0: none
  double last_h_s_ = 0, start_h_s_ = 0;  ///< of the last substep; of the last one before the frame

  bool crumpled_ = false;
  bool second_solve_ = false;       ///< chains are solved again between the response rounds
  std::unique_ptr<Lines> lines_;    ///< if links are uniform
  std::unique_ptr<Chains> chains_;  ///< otherwise
  std::unique_ptr<XpbdContact> contact_;
  std::unique_ptr<FusedFrame> fused_frame_;  ///< null: one kernel per pass
  const FrameKernel* move_grips_ = nullptr;
  static constexpr std::uint32_t kMaxGrowth = 64;  ///< of lists with 32-bit capacities
  std::uint32_t growth_ = 1;                       ///< of the lists of self-contact, since loading or a reset
  bool grows_ = false;
  bool can_grow_ = false;             ///< with self-contact and without motion given from outside
  bool repeats_ = false;              ///< the frame being recorded repeats the last one
  std::vector<FrameCost> repeated_;   ///< attempts of the last frame before the one that counts
  XpbdContact::Measured measured_{};  ///< of the last frame
  /// Buffers of the state, and of the state at the frame's start, in scenes whose frames may be repeated.
  std::vector<std::pair<const vulkan::Buffer*, const vulkan::Buffer*>> saved_;
};

}  // namespace

std::unique_ptr<GpuSolver> make_xpbd(const nlohmann::json& settings, const DeviceOptions& device) {
  check_xpbd_settings(settings);
  return std::make_unique<Xpbd>(xpbd_info(), settings, device);
}

/// Free fall [m]: the prediction of every substep, which without internal forces is the whole substep.
double xpbd_free_fall_m(const Scene& scene, const nlohmann::json& settings, int frames) {
  const int substeps = xpbd_substeps(scene, settings);
  const double h = scene.time.dt() / substeps, g = scene.gravity_m_per_s2[1];
  const double damping = scene.needs.has(Feature::Damping) ? scene.material.damping_per_s : 0;
  const bool uses_bdf2 = bdf2_decision(scene, settings).enabled;
  double v = scene.cloth.initial_velocity_m_per_s[1], x = 0, last_v = v, last_x = x;
  for (long i = 0; i < static_cast<long>(frames) * substeps; ++i) {
    const TimeStep step = time_step(uses_bdf2, h, i > 0 ? h : 0, damping);
    const double from_v = v + step.history_weight * (v - last_v), from_x = x + step.history_weight * (x - last_x);
    last_v = v;
    last_x = x;
    v = from_v + step.force_scale * g * step.implicit_h_s - step.damping_fraction * from_v;
    x = from_x + v * step.implicit_h_s;
  }
  return x;
}

}  // namespace clothbench::pbd_gpu
