#include "xr/loop.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <thread>

#include "clothbench/vector.hpp"
#include "common/gpu_solver.hpp"
#include "results/store.hpp"
#include "runner/frame_loop.hpp"
#include "runner/interrupt.hpp"
#include "runner/solver_run.hpp"
#include "xr/live_scene.hpp"
#include "xr/session.hpp"

namespace clothbench::xr {
namespace {

using Clock = std::chrono::steady_clock;
using assets::Side;

double seconds(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

HandsNow hands_at(const std::optional<Hands>& hands, const LiveScene& live, XrTime time) {
  HandsNow now;
  for (const Side side : {Side::Left, Side::Right})
    if (hands && live.wants(side)) now[static_cast<std::size_t>(side)] = hands->at(side, time);
  return now;
}

class Loop {
 public:
  Loop(const LoopOptions& options, const Instance& xr, LiveScene& live, Session& session,
       std::shared_ptr<vulkan::Device> device)
      : o_(options), live_(live), session_(session), device_(device), painter_(device, session) {
    if (live.wants(Side::Left) || live.wants(Side::Right)) hands_.emplace(session);
    if (options.table) search_.emplace(session, minus(LiveScene::kMiddle_m, live.place_m()));
    show_at_rest();
    tell(fmt::format("{} on {}; {} x {} pixels per eye", xr.system_name(), xr.runtime_name(), session.extent().width,
                     session.extent().height));
  }

  LoopResult run() {
    try {
      show_frames();
    } catch (const std::exception& e) {
      // The frames recorded so far are a result that can be replayed: a headset's device may be lost at any time.
      if (log_.rows().empty()) throw;
      end_by(e);
    }
    if (log_.rows().empty())
      throw Error(interrupt_requested() ? "interrupted before the session began"
                                        : "the headset ended the session before it began",
                  interrupt_requested() ? ExitCode::Interrupted : ExitCode::CheckFailed);
    return finish();
  }

 private:
  static constexpr double kLeave_s = 2;  // then the loop ends even if the runtime does not end the session

  void show_frames() {
    const auto start = Clock::now();
    while (session_.pump()) {
      done_ = done_ || interrupt_requested();
      if (done_ && !asked_to_exit_) {
        session_.request_exit();
        asked_to_exit_ = true;
        leaving_ = Clock::now();
      }
      if (asked_to_exit_ && (!session_.running() || seconds(leaving_, Clock::now()) > kLeave_s)) break;
      if (!session_.running()) {
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
      } else {
        frame();
      }
      if (run_ == nullptr && !asked_to_exit_ && seconds(start, Clock::now()) > o_.timeout_s)
        throw Error(fmt::format("the session did not begin within {:g} s: {}", o_.timeout_s,
                                session_.running() ? "no hand was seen" : "the headset does not run it (is it worn?)"),
                    ExitCode::CheckFailed);
    }
    painter_.wait();
  }

  /// Ends the session with this error, unless it already has an outcome. If a frame had begun, that frame failed.
  void end_by(const std::exception& e) {
    done_ = true;
    if (outcome_.status != "ok") return;
    const auto* failure = dynamic_cast<const vulkan::Failure*>(&e);
    const VkResult result = failure != nullptr ? failure->result() : VK_SUCCESS;
    const char* status = result == VK_ERROR_DEVICE_LOST ? "device_lost" : result == VK_TIMEOUT ? "timed_out" : "error";
    outcome_ = {status, "F3", static_cast<int>(log_.rows().size()), e.what()};
  }

  void tell(const std::string& text) const {
    if (o_.tell) o_.tell(text);
  }

  /// Shows the cloth before the session is live, so that the user sees where it is.
  void show_at_rest() {
    const Scene& s = live_.written();
    painter_.renderer().set_cloth(s.cloth, {0, 0, 0});
    painter_.renderer().write_positions(initial_positions(s));
    shown_.cloth = s.cloth;
  }

  void frame() {
    const XrFrameState state = session_.wait_frame();
    const auto start = Clock::now();
    session_.begin_frame();
    const bool live = run_ != nullptr && !done_;
    FrameRow row;
    if (live && log_.rows().empty()) first_time_ = state.predictedDisplayTime;
    row.predicted_display_s = static_cast<double>(state.predictedDisplayTime - first_time_) * 1e-9;
    row.predicted_period_s = static_cast<double>(state.predictedDisplayPeriod) * 1e-9;
    live ? step(state.predictedDisplayTime, row) : prepare(state);
    try {
      show(state);
    } catch (...) {
      if (live) log_.add(row), counters_->read();  // it was stepped and recorded
      throw;
    }
    row.frame_s = seconds(start, Clock::now());
    if (!live) return;
    log_.add(row);
    counters_->read();  // outside all measured times
    done_ = done_ || static_cast<int>(log_.rows().size()) == frames_;
  }

  /// Draws both eyes, unless the device is lost.
  void show(const XrFrameState& state) {
    std::vector<XrView> views;
    if (state.shouldRender == XR_TRUE && outcome_.status != "device_lost")
      views = session_.views(state.predictedDisplayTime);
    if (!views.empty()) paint(views);
    session_.end_frame(state, views);
  }

  /// Handles frames before the session's first one, until rate and hands are known. The session begins twice: the first
  /// time, solvers compile their kernels, during which the hands move on.
  void prepare(const XrFrameState& state) {
    if (!counters_) counters_.emplace(session_);
    if (done_ || !rate_settled(static_cast<double>(state.predictedDisplayPeriod) * 1e-9)) return;
    if (search_ && !found_table(state.predictedDisplayTime)) return;
    LiveScene::Begin b;
    b.hands = hands_at(hands_, live_, state.predictedDisplayTime);
    for (const Side side : {Side::Left, Side::Right})
      if (live_.wants(side) && !b.hands[static_cast<std::size_t>(side)]) return;
    b.frame_rate_hz = rate_hz_;
    b.frames =
        o_.frames > 0 ? o_.frames : static_cast<int>(std::lround(live_.written().time.duration_s * b.frame_rate_hz));
    frames_ = b.frames;
    b.has_capsules = hands_ && hands_->has_capsules();
    painter_.wait();
    run_.reset();
    live_.begin(b);
    auto run = std::make_unique<SolverRun>(RunSpec{&live_.scene(), o_.entry, o_.settings, o_.setting}, o_.device, "xr");
    if (!run->alive()) {
      const Outcome out = run->outcome();
      throw Error(fmt::format("{}: {}: {}", o_.entry->info.name, out.status, out.message), ExitCode::CheckFailed);
    }
    if (!warm_) {
      run->solver()->step(frame_input(live_.scene(), 0));
      warm_ = true;
      return;
    }
    run_ = std::move(run);
    show_live();
    tell(fmt::format("{} frames at {:g} Hz", frames_, b.frame_rate_hz));
  }

  /// Whether the scene is on the user's table.
  bool found_table(XrTime time) {
    if (const nlohmann::json table = search_->step(time); !table.is_null()) {
      session_.create_space(minus(live_.place_m(), live_.put_on(table)));
      search_.reset();
      tell("on the user's table, size " + dump(table["size_m"]) + " m");
    } else if (seconds(first_frame_, Clock::now()) > std::min(10.0, o_.timeout_s / 2)) {
      throw Error("no table was found: mark it in the headset's room settings, or leave --table out",
                  ExitCode::CheckFailed);
    }
    return !search_;
  }

  /// A display changes to a requested rate after some frames, if it offers that rate. Otherwise the highest rate seen
  /// is used: after slow frames, such as a solver's first, runtimes report multiples of the display's period.
  bool rate_settled(double period_s) {
    constexpr double kTimeout_s = 1, kSame_hz = 0.5, kFastest_hz = 1000;
    if (first_frame_ == Clock::time_point{}) first_frame_ = Clock::now();
    if (settled_) return true;
    const double hz = std::round(1 / period_s);  // periods are whole ns
    const bool asked = std::abs(hz - o_.rate_hz) <= kSame_hz;
    if (asked || (hz > rate_hz_ && hz <= kFastest_hz)) rate_hz_ = hz;
    settled_ = asked || (rate_hz_ > 0 && seconds(first_frame_, Clock::now()) > kTimeout_s);
    return settled_;
  }

  /// Lets the vertex shader read a GPU solver's positions from the solver's own buffer.
  void show_live() {
    const Scene& s = live_.scene();
    painter_.renderer().set_cloth(s.cloth, {0, 0, 0});
    gpu_ = dynamic_cast<const pbd_gpu::GpuSolver*>(run_->solver());
    shown_ = {};
    shown_.cloth = s.cloth;
    shown_.colliders = s.colliders;
    if (!live_.motion().empty()) shown_.motion.push_back(live_.motion().front());
    near_ = render::Bounds::of(initial_positions(s));
    near_.grow(std::max(s.cloth.width_m, s.cloth.height_m));
    stale_ = true;
  }

  void step(XrTime time, FrameRow& row) {
    const auto index = static_cast<int>(log_.rows().size());
    const HandsNow now = hands_at(hands_, live_, time);
    if (live_.wants(Side::Left)) row.left_seen = now[0] ? 1 : 0;
    if (live_.wants(Side::Right)) row.right_seen = now[1] ? 1 : 0;
    painter_.wait();  // it reads the positions that the step overwrites
    row.paint_device_s = painter_.device_s();
    // From here on the recording has the frame, so the log must get it too, whatever happens below.
    FrameInput input = frame_input(live_.scene(), index);
    input.motion = live_.next(index, now);
    const auto start = Clock::now();
    StepStatus status = StepStatus::Ok;
    try {
      status = run_->solver()->step(input);
    } catch (const std::exception& e) {
      end_by(e);
    }
    log_.add_step(run_->solver()->last_cost(), seconds(start, Clock::now()));
    if (status != StepStatus::Ok) {
      outcome_ = outcome_of(status, index);
      done_ = true;
    }
    shown_.motion.clear();
    if (input.motion != nullptr) shown_.motion.push_back(*input.motion);
    stale_ = stale_ || input.motion != nullptr;
  }

  void paint(const std::vector<XrView>& views) {
    painter_.wait();
    if (run_ != nullptr) {
      if (gpu_ == nullptr) {
        run_->solver()->read_state(state_);
        painter_.renderer().write_positions(state_.position);
      } else {
        painter_.renderer().use_positions(gpu_->position_buffer(), gpu_->origin_m());
      }
      if (stale_) painter_.renderer().set_surfaces(render::surfaces(shown_, 0, near_));
      stale_ = false;
    }
    painter_.paint(views);
  }

  StoredGroup group(const ClothState& end) const {
    StoredGroup g = log_.group();
    g.attributes = {{"runtime", session_.instance().runtime_name()},
                    {"system", session_.instance().system_name()},
                    {"rate_requested_hz", o_.rate_hz},
                    {"rate_hz", live_.scene().time.frame_rate_hz},
                    {"eye_width", session_.extent().width},
                    {"eye_height", session_.extent().height},
                    {"hands", !hands_                  ? "scripted"
                              : hands_->has_capsules() ? "live, capsules of the runtime"
                                                       : "live, joints and radii"}};
    const std::uint64_t n = live_.scene().cloth.vertex_count();
    g.arrays.push_back(
        {"final_position_m", "m", "positions of the cloth after the last frame", {"vertex", "xyz"}, {n, 3}});
    g.arrays.back().values = end.position;
    return g;
  }

  /// Contains NaN if the device is lost.
  ClothState last_state() {
    ClothState end;
    try {
      run_->solver()->read_state(end);
    } catch (const Error& e) {
      if (outcome_.status == "ok") outcome_ = {"device_lost", "F3", static_cast<int>(log_.rows().size()), e.what()};
      end.position.assign(3 * live_.scene().cloth.vertex_count(), kMissing);
    }
    return end;
  }

  LoopResult finish() {
    LoopResult r;
    const ClothState end = last_state();
    r.final_position_m = end.position;
    for (const double x : end.position)
      if (outcome_.status == "ok" && !std::isfinite(x))
        outcome_ = {"not_finite", "F0", static_cast<int>(log_.rows().size()), "a position is not finite"};
    r.scenario = live_.save();
    Scene moved = live_.scene();
    moved.motion = live_.motion();
    std::vector<StoredGroup> groups = replay_of(moved);
    groups.push_back(group(end));
    r.counters = counters_->group();
    if (!r.counters.arrays.empty()) groups.push_back(r.counters);
    RunRecord record;
    record.header = run_->header();
    record.outcome = outcome_;
    record.trials = {log_.trial()};
    r.summary = summarise(run_->spec(), run_->plan(), record);
    r.summary.merge(log_.summary());
    RunWriter writer(o_.out, run_->header());
    writer.write_trial(log_.trial());
    writer.write_replay(groups);
    r.file = writer.finish(outcome_, r.summary);
    r.log = log_;
    r.outcome = outcome_;
    r.validation_messages = device_->validation_messages();  // the session's device: includes messages about rendering
    return r;
  }

  const LoopOptions& o_;
  LiveScene& live_;
  Session& session_;
  std::shared_ptr<vulkan::Device> device_;
  Painter painter_;
  std::optional<Hands> hands_;
  std::optional<Counters> counters_;   ///< from the first frame on
  std::optional<TableSearch> search_;  ///< until the table is found
  std::unique_ptr<SolverRun> run_;
  const pbd_gpu::GpuSolver* gpu_ = nullptr;
  bool warm_ = false, done_ = false, asked_to_exit_ = false, stale_ = true;
  Clock::time_point leaving_, first_frame_;
  double rate_hz_ = 0;  ///< refresh rate, known once `settled_`
  bool settled_ = false;
  int frames_ = 0;
  XrTime first_time_ = 0;
  FrameLog log_;
  Outcome outcome_;
  ClothState state_;
  Scene shown_;  ///< drawn together with the cloth
  render::Bounds near_ = render::Bounds::none();
};

}  // namespace

LoopResult run_loop(const LoopOptions& options) {
  const Instance xr;
  const ResultFolder held(options.out, {}, "clothbench xr");
  LiveScene live(options.scenario, options.overrides, options.out / "scenario", xr.tracks_hands());
  const std::shared_ptr<vulkan::Device> device = xr.make_device(options.device);
  Session session(xr, device, {options.rate_hz, live.place_m()});
  return Loop(options, xr, live, session, device).run();
}

}  // namespace clothbench::xr
