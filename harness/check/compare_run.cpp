#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>

#include "base/words.hpp"
#include "check/compare.hpp"
#include "clothbench/error.hpp"
#include "metrics/collider_contact.hpp"
#include "results/store.hpp"

namespace clothbench {
namespace {

/// A blow-up grows exponentially from rounding errors, so the frame in which it is detected differs between devices.
constexpr int kFailedFrameSlack = 2;
constexpr double kFailedFrameRelativeSlack = 0.1;

constexpr const char* kNotMeasured = "not measured";

/// Sides [m] of the cloth grid, or of the bounding box of its mesh; none if the result file has neither.
std::optional<std::array<double, 2>> cloth_size_m(const RunRecord& r) {
  const nlohmann::json scene = json_or_discarded(r.header.scenario_json);
  const nlohmann::json::json_pointer width("/cloth/size_m/0"), height("/cloth/size_m/1");
  if (!r.file.empty() && scene.is_object() && scene.contains(nlohmann::json::json_pointer("/cloth/mesh"))) {
    const Cloth cloth = read_motion(r.file).scene.cloth;
    if (!cloth.mesh) return {};
    return {{cloth.width_m, cloth.height_m}};
  }
  const auto is_number = [&](const auto& at) { return scene.contains(at) && scene[at].is_number(); };
  if (scene.is_discarded() || !is_number(width) || !is_number(height)) return {};
  return {{scene[width].get<double>(), scene[height].get<double>()}};
}

/// Shorter side of the cloth [m].
double length_of(const RunRecord& r) {
  const auto size = cloth_size_m(r);
  if (!size) throw Error(r.header.scene + ": the result file has no cloth mesh and no /cloth/size_m of two numbers");
  return std::min((*size)[0], (*size)[1]);
}

std::string outcome_text(const BaselineRun& c) {
  std::string text = c.status;
  if (c.klass != "ok") text += " " + c.klass;
  if (c.failed_frame >= 0) text += fmt::format(" at frame {}", c.failed_frame);
  return text;
}

/// Empty if the outcomes agree.
std::vector<Finding> compare_outcome(const BaselineRun& was, const BaselineRun& is, const std::string& message) {
  Finding f{Verdict::Failed, "outcome", outcome_text(was), outcome_text(is), "", message};
  if (was.status != is.status || was.klass != is.klass) {
    const bool worked_before = was.status == "ok", works = is.status == "ok";
    if (works && (!worked_before || is.klass == "ok")) f.verdict = Verdict::Improved;
    return {f};
  }
  if (was.failed_frame == is.failed_frame) return {};
  const double frames = kFailedFrameSlack + kFailedFrameRelativeSlack * was.failed_frame;
  f.allowed = fmt::format("frame {:.0f} or later", std::max(0.0, std::ceil(was.failed_frame - frames)));
  if (was.failed_frame < 0 || is.failed_frame < 0) return {f};
  if (is.failed_frame < was.failed_frame - frames) return {f};
  if (is.failed_frame <= was.failed_frame + frames) return {};
  f.verdict = Verdict::Improved;
  return {f};
}

std::vector<Finding> compare_stages(const BaselineRun& was, const BaselineRun& is) {
  if (was.stages == is.stages) return {};
  const auto without = [](std::vector<std::string> a, const std::vector<std::string>& b) {
    std::erase_if(a, [&](const std::string& s) { return contains(b, s); });
    return joined(a);
  };
  const std::string added = without(is.stages, was.stages), gone = without(was.stages, is.stages);
  std::string message;
  if (!added.empty()) message = "not in the baseline: " + added;
  if (!gone.empty()) message += (message.empty() ? "" : "; ") + ("missing: " + gone);
  if (message.empty()) message = "the same stages in another order or number";
  return {{Verdict::Failed, "stages", fmt::format("{} stages", was.stages.size()),
           fmt::format("{} stages", is.stages.size()), "", message}};
}

/// Two trials with equal times in every frame are copies of one trial: times with ns resolution do not repeat.
std::vector<Finding> compare_trials(const RunRecord& r) {
  for (std::size_t i = 0; i < r.trials.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const std::vector<double>&a = r.trials[i].frame_wall_s, &b = r.trials[j].frame_wall_s;
      const bool varies = std::any_of(a.begin(), a.end(), [&](double t) { return t != a.front(); });
      if (varies && a == b)
        return {{Verdict::Failed, "trials", "each trial timed separately",
                 fmt::format("trial {} repeats trial {}", i, j), "", ""}};
    }
  return {};
}

std::string shown(const std::string& name, double v) {
  if (!std::isfinite(v)) return kNotMeasured;
  if (is_verdict(name) && (v == 0 || v == 1)) return v == 1 ? "pass" : "fail";
  return fmt::format("{:.6g}", v);
}

/// NaN fails, because a value passes only if a comparison is true.
Verdict judge(const std::string& name, double was, double is, double slack) {
  if (!std::isfinite(was)) return std::isfinite(is) ? Verdict::New : Verdict::Same;
  if (is_verdict(name)) return is == was ? Verdict::Same : is > was ? Verdict::Improved : Verdict::Failed;
  if (!(is <= was + slack)) return Verdict::Failed;
  return is < was - slack ? Verdict::Improved : Verdict::Same;
}

double scalar(const BaselineRun& c, const std::string& name) {
  const auto at = c.scalars.find(name);
  return at == c.scalars.end() ? kMissing : at->second;
}

/// Names of the scalars in `was` or `is`.
std::set<std::string> scalar_names(const BaselineRun& was, const BaselineRun& is) {
  std::set<std::string> out;
  for (const BaselineRun* c : {&was, &is})
    for (const auto& [name, unused] : c->scalars) out.insert(name);
  return out;
}

std::vector<Finding> compare_scalars(const BaselineRun& was, const BaselineRun& is, const RunRecord& record) {
  std::vector<Finding> out;
  std::optional<double> length;
  for (const std::string& name : scalar_names(was, is)) {
    const double before = scalar(was, name), now = scalar(is, name);
    const Gate& gate = *find_gate(name);
    // Records of measured moduli or of relations between runs have no cloth: read the length only if the rule needs it.
    if (gate.unit != SlackUnit::One && !length) length = length_of(record);
    const double tolerance = slack(gate, before, gate.unit == SlackUnit::One ? 1 : *length);
    const Verdict verdict = judge(name, before, now, tolerance);
    if (verdict == Verdict::Same) continue;
    const std::string limit = !is_verdict(name) && std::isfinite(before) ? "≤ " + shown(name, before + tolerance) : "";
    out.push_back({verdict, name, shown(name, before), shown(name, now), limit, ""});
  }
  return out;
}

constexpr double kSameResult = 1e-9;  // relative
constexpr const char* kMotionDistance = "positions, maximum distance over L";

std::vector<float> positions_of(const RunRecord& c) {
  return !c.accuracy.position.empty() || c.file.empty() ? c.accuracy.position : read_run(c.file).accuracy.position;
}

/// Maximum vertex distance between the motions over the longer side; NaN if frames differ or the cloth size is unknown.
double motion_distance(const RunRecord& a, const RunRecord& b) {
  const std::vector<float> p = positions_of(a), q = positions_of(b);
  const auto size = cloth_size_m(a);
  if (p.empty() || p.size() != q.size() || !size) return kMissing;
  double most = 0;
  for (std::size_t k = 0; k + 2 < p.size(); k += 3) {
    const double d = std::hypot(double{p[k]} - q[k], double{p[k + 1]} - q[k + 1], double{p[k + 2]} - q[k + 2]);
    most = max_or_nan(most, d);
  }
  return most / std::max((*size)[0], (*size)[1]);
}

}  // namespace

std::vector<Finding> motion_findings(const RunRecord& r) {
  if (r.file.empty()) return {};
  if (const std::string fault = trajectory_fault(r.file); !fault.empty())
    return {
        {Verdict::Failed, "positions", "the outcome's motion", "a different one, or none", "", r.file + ": " + fault}};
  if (!r.summary.contains(kMotionCheck + "finite") || std::filesystem::is_directory(r.file)) return {};
  // The motion is read from the file; the summary's own statement about it is not trusted.
  const StoredMotion motion = read_motion(r.file);
  if (!kWithContactMetrics && !motion.scene.colliders.empty()) return {};
  std::vector<Finding> out;
  for (const motion_check::Finding& f :
       motion_check::verify(motion.scene, {motion.time_s, motion.position}, motion.contact_margins_m)) {
    const std::string name = kMotionCheck + f.statistic->name;
    const auto stored = r.summary.find(name);
    const bool passed = stored == r.summary.end() || stored->second <= 1;
    if (!(f.ratio <= 1) && passed)
      out.push_back({Verdict::Failed, name,
                     stored == r.summary.end() ? kNotMeasured : fmt::format("{:.6g}", stored->second),
                     fmt::format("{:.6g}", f.ratio), "≤ 1",
                     fmt::format("{}: recomputed from the positions, frame {}", r.file, f.frame)});
  }
  return out;
}

std::vector<Finding> compare_run(const BaselineRun& was, const RunRecord& record) {
  const BaselineRun is = gated_part(record);
  std::vector<Finding> out = motion_findings(record);
  const std::vector<Finding> of_outcome = compare_outcome(was, is, record.outcome.message);
  out.insert(out.end(), of_outcome.begin(), of_outcome.end());
  if (was.status != is.status) return out;
  for (const auto& part : {compare_stages(was, is), compare_trials(record), compare_scalars(was, is, record)})
    out.insert(out.end(), part.begin(), part.end());
  return out;
}

std::vector<Finding> compare_records(const RunRecord& a, const RunRecord& b) {
  const BaselineRun was = whole_part(a), is = whole_part(b);
  std::vector<Finding> out = compare_outcome(was, is, b.outcome.message);
  const bool same_outcome = out.empty();
  for (const Finding& f : compare_stages(was, is)) out.push_back(f);
  bool differ = false;
  for (const std::string& name : scalar_names(was, is)) {
    const double before = scalar(was, name), now = scalar(is, name);
    if (std::abs(now - before) <= kSameResult * std::max(std::abs(before), std::abs(now))) continue;
    differ = true;
    out.push_back(
        {Verdict::Changed, name, shown(name, before), shown(name, now), fmt::format("± {:g} of it", kSameResult), ""});
  }
  if (const double apart = differ && same_outcome ? motion_distance(a, b) : kMissing; std::isfinite(apart))
    out.push_back({Verdict::Changed, kMotionDistance, "–", fmt::format("{:.3g}", apart), "0", ""});
  for (Finding& f : out) f.verdict = Verdict::Changed;
  return out;
}

}  // namespace clothbench
