#include "trial.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <map>

#include "base/interval.hpp"
#include "clothbench/error.hpp"

namespace clothbench::liars {
namespace {

/// Differences below this multiple of the resolution are no lie.
constexpr double kNoticed = 10e-4;

std::string scene_file(const std::string& kind, std::uint64_t seed) {
  return fmt::format("{}-{}", kind.substr(kind.rfind('/') + 1), seed);
}

/// Motions of one scene by one solver, computed once.
class Source {
 public:
  Source(const Matrix& m, std::string kind, std::uint64_t seed)
      : matrix_(m),
        kind_(std::move(kind)),
        seed_(seed),
        scene_(std::make_shared<const Scene>(draw_scene(kind_, seed))) {}

  std::vector<RightSolver> solvers() const {
    std::vector<RightSolver> out = right_solvers(*scene_);
    if (!matrix_.solver.empty()) std::erase_if(out, [&](const auto& s) { return s.label() != matrix_.solver; });
    return out;
  }

  std::optional<Motion> motion(const RightSolver& with, const std::string& what,
                               const std::function<void(Scene&)>& changed) const {
    const std::filesystem::path file =
        matrix_.motion_cache / fmt::format("{}-{}-{}.motion", scene_file(kind_, seed_), with.name, what);
    Motion known{scene_, with.label(), {}, {}, {}};
    if (!matrix_.motion_cache.empty() && read_motion(known, file)) return known;
    std::optional<Motion> out = run(scene_, with, changed);
    if (out && !matrix_.motion_cache.empty()) {
      std::filesystem::create_directories(matrix_.motion_cache);
      write_motion(*out, file);
    }
    return out;
  }

  const Scene& scene() const { return *scene_; }

 private:
  const Matrix& matrix_;
  std::string kind_;
  std::uint64_t seed_;
  std::shared_ptr<const Scene> scene_;
};

Trial judged(const Right& right, const Lie& lie, const Motion& told) {
  Trial t;
  t.lie = lie.name;
  t.right = lie.right;
  t.solver = right.motion.solver;
  t.determined = lie.determined(right, told);
  t.difference_m = difference_m(right, told);
  t.findings = motion_check::verify(*told.scene, {told.time_s, told.position}, told.contact_offsets_m);
  return t;
}

std::string of(const Trial& t) { return fmt::format("{} {} {}", t.kind, t.seed, t.solver); }

std::string worst_of(const Trial& t) {
  const motion_check::Finding& f = t.worst();
  return fmt::format("{} {:.3g} in frame {}", f.statistic->name, f.ratio, f.frame);
}

std::string share(std::size_t some, std::size_t all) {
  if (all == 0) return "none";
  const Interval i = wilson_95(some, all);
  return fmt::format("{} of {}, {:.1f} % (95 %: {:.1f} to {:.1f} %)", some, all,
                     100.0 * static_cast<double>(some) / static_cast<double>(all), 100 * i.low, 100 * i.high);
}

}  // namespace

bool Trial::failed() const { return !(worst().ratio <= 1); }

std::vector<Trial> tell_all(const Matrix& matrix, void (*progress)(const std::string&)) {
  std::vector<Trial> out;
  const std::vector<std::string>& kinds = matrix.kinds.empty() ? scene_kinds() : matrix.kinds;
  for (int i = 0; i < matrix.motions; ++i) {
    const std::uint64_t seed = matrix.seed + static_cast<std::uint64_t>(i);
    const std::string& kind = kinds[seed % kinds.size()];
    const Source source(matrix, kind, seed);
    const std::vector<RightSolver> with = source.solvers();
    if (with.empty()) continue;
    const RightSolver& solver = with[seed / kinds.size() % with.size()];
    std::optional<Motion> motion = source.motion(solver, "right", nullptr);
    if (!motion) continue;
    Right right{std::move(*motion), {}, [&](const char* what, const std::function<void(Scene&)>& changed) {
                  return source.motion(solver, what, changed);
                }};
    right.facts = facts_of(right.motion);
    const auto add = [&](Trial t, const Motion& told) {
      t.kind = kind;
      t.seed = seed;
      if (!matrix.store.empty() && told.frames() == right.motion.frames()) {
        t.number = static_cast<int>(out.size());
        write_motion(told, matrix.store / fmt::format("{}.motion", t.number));
      }
      out.push_back(std::move(t));
    };
    if (!matrix.store.empty()) {
      std::filesystem::create_directories(matrix.store);
      std::ofstream(matrix.store / fmt::format("{}.json", scene_file(kind, seed))) << source.scene().json;
    }
    bool trusted = true;
    for (const Lie& lie : lies()) {
      if (!trusted || !lie.applies(right.facts)) continue;
      if (!lie.right && !matrix.only_lie.empty() && matrix.only_lie != lie.name) continue;
      Dice dice(seed, lie.name);
      const std::optional<Motion> told = lie.tell(right, dice);
      if (!told) continue;
      Trial t = judged(right, lie, *told);
      if (!lie.right && !(t.difference_m > kNoticed * right.facts.length_m)) continue;
      // What fails as it is cannot show whether a lie is seen.
      if (lie.right && t.failed()) trusted = false;
      add(std::move(t), *told);
    }
    if (progress) progress(fmt::format("{} of {}: {} {} {}", i + 1, matrix.motions, kind, seed, solver.label()));
  }
  return out;
}

Totals totals(const std::vector<Trial>& trials) {
  Totals n;
  for (const Trial& t : trials) {
    const bool failed = t.failed();
    if (t.right && t.lie == lies()[0].name)
      ++n.right, n.passed += !failed;
    else if (t.right)
      ++n.noisy, n.noisy_passed += !failed;
    else if (t.determined)
      ++n.told, n.caught += failed;
    else
      ++n.undetermined, n.undetermined_caught += failed;
  }
  return n;
}

std::string as_text(const std::vector<Trial>& trials) {
  std::string out = fmt::format("{:<42} {:>9} {:>9}  by\n", "lie", "caught", "others");
  for (const Lie& lie : lies()) {
    if (lie.right) continue;
    std::array<std::size_t, 4> count{};
    std::map<std::string, int> by;
    for (const Trial& t : trials) {
      if (t.lie != lie.name) continue;
      const std::size_t at = t.determined ? 0 : 2;
      count[at] += t.failed();
      ++count[at + 1];
      if (t.failed())
        ++by[fmt::format("{} {}", motion_check::name_of(t.worst().statistic->check), t.worst().statistic->name)];
    }
    if (count[1] + count[3] == 0) continue;
    std::vector<std::pair<int, std::string>> order;
    for (const auto& [name, n] : by) order.emplace_back(n, name);
    std::sort(order.rbegin(), order.rend());
    std::string names;
    for (const auto& [n, name] : order) names += fmt::format("{}{} {}", names.empty() ? "" : ", ", name, n);
    out += fmt::format("{:<42} {:>9} {:>9}  {}\n", lie.name, fmt::format("{}/{}", count[0], count[1]),
                       count[3] == 0 ? "" : fmt::format("{}/{}", count[2], count[3]), names);
  }
  out += "\nright and failed:\n";
  for (const Trial& t : trials)
    if (t.right && t.failed()) out += fmt::format("  {}: {}: {}\n", of(t), t.lie, worst_of(t));
  out += "\nwrong and passed, though positions determine it:\n";
  for (const Trial& t : trials)
    if (!t.right && t.determined && !t.failed())
      out += fmt::format("  {}: {}: {}, off by {:.3g} m\n", of(t), t.lie, worst_of(t), t.difference_m);
  out += "\nright motions failed by check:\n";
  for (const auto check : {motion_check::Check::Kinematic, motion_check::Check::Dynamic,
                           motion_check::Check::Continuous, motion_check::Check::Present}) {
    std::size_t told = 0, failed = 0;
    for (const Trial& t : trials)
      if (t.right && t.lie == lies()[0].name) {
        ++told;
        failed += std::any_of(t.findings.begin(), t.findings.end(), [check](const motion_check::Finding& f) {
          return f.statistic->check == check && !(f.ratio <= 1);
        });
      }
    out += fmt::format("  {:<11} {}\n", motion_check::name_of(check), share(failed, told));
  }
  const Totals n = totals(trials);
  out += fmt::format("\nlies that positions determine, caught: {}\n", share(n.caught, n.told));
  out += fmt::format("lies that they do not determine, caught: {}\n", share(n.undetermined_caught, n.undetermined));
  out += fmt::format("right motions passed: {}\n", share(n.passed, n.right));
  out += fmt::format("right motions with noise passed: {}\n", share(n.noisy_passed, n.noisy));
  return out;
}

nlohmann::json as_json(const std::vector<Trial>& trials) {
  nlohmann::json rows = nlohmann::json::array();
  for (const Trial& t : trials) {
    nlohmann::json ratios = nlohmann::json::object();
    for (const motion_check::Finding& f : t.findings) ratios[f.statistic->name] = {f.ratio, f.frame};
    rows.push_back({{"kind", t.kind},
                    {"seed", t.seed},
                    {"solver", t.solver},
                    {"lie", t.lie},
                    {"scene", scene_file(t.kind, t.seed)},
                    {"motion", t.number},
                    {"statistic", t.worst().statistic->name},
                    {"right", t.right},
                    {"determined", t.determined},
                    {"failed", t.failed()},
                    {"difference_m", t.difference_m},
                    {"findings", ratios}});
  }
  const Totals n = totals(trials);
  return {{"trials", rows},
          {"determined", {{"caught", n.caught}, {"told", n.told}}},
          {"undetermined", {{"caught", n.undetermined_caught}, {"told", n.undetermined}}},
          {"right", {{"passed", n.passed}, {"told", n.right}}},
          {"noisy", {{"passed", n.noisy_passed}, {"told", n.noisy}}}};
}

}  // namespace clothbench::liars
