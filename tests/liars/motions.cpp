#include "motions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>

#include "base/dice.hpp"
#include "base/json_text.hpp"
#include "clothbench/solver.hpp"
#include "scenario/draw_contact.hpp"
#include "scenario/load.hpp"

namespace clothbench::liars {
namespace {

using nlohmann::json;

/// One kind of scene.
struct Kind {
  std::string name;
  std::function<Scene(std::uint64_t seed)> draw;
};

std::string grid_of(Dice& dice, bool odd = false) {
  const int side = odd ? 2 * dice.whole(6, 9) + 1 : dice.whole(12, 20);
  return fmt::format("cloth.grid=[{},{}]", side, side);
}

std::string rate_of(Dice& dice) {
  static constexpr std::array kRates = {60, 72, 90, 120, 144};
  return fmt::format("time.frame_rate_hz={}", kRates[static_cast<std::size_t>(dice.whole(0, 4))]);
}

/// The kinds of the studies `contact` and `physics` on small grids. Frame rates are the study's if a hand is fast or
/// the rate is random.
void add_drawn(std::vector<Kind>& out) {
  for (const std::string study : {"contact", "physics"}) {
    const std::filesystem::path file = find_scenario(study);
    json scenes = json::parse(read_text(file))["scenes"];
    for (json& entry : scenes) {
      entry["draw"].emplace("set", json::object());
      const ContactKind kind = contact_kind(entry, file.parent_path() / entry["file"].get<std::string>(), study,
                                            json{{"ranges", {{"grid", {12, 20}}}}});
      out.push_back({kind.name, [kind, study](std::uint64_t seed) {
                       static ContactDrawer drawer(Assets::MayBeProcedural);
                       const json scene = drawer.draw(kind, study, seed);
                       Dice dice(seed, "rate");
                       std::vector<std::string> set;
                       if (kind.name == "free-fall" || kind.name.starts_with("incline"))
                         set.emplace_back("cloth.grid=[16,16]");
                       else if (study == "contact" && kind.how != "sweep" && kind.how != "push" &&
                                kind.how != "stretch")
                         set.push_back(rate_of(dice));
                       return scene_from_json(scene, kind.name, set);
                     }});
    }
  }
}

/// Scenes of the paper and of contact, with a different grid, frame rate, stiffness and density.
void add_files(std::vector<Kind>& out) {
  for (const char* name : {"paper/gravity", "paper/capsule-sweep", "paper/hand-push", "paper/two-hand-stretch-2mps",
                           "paper/desk-flat-low", "paper/desk-corner-low", "contact/plane", "contact/open-sheet",
                           "contact/desk-slide", "contact/self-fold", "validation/hang"})
    out.push_back({name, [name](std::uint64_t seed) {
                     Dice dice(seed, name);
                     const bool stretched = std::strstr(name, "stretch") != nullptr;  // hands hold the middle of a side
                     std::vector<std::string> set = {grid_of(dice, stretched)};
                     const std::string rate = rate_of(dice);
                     if (!stretched) set.push_back(rate);
                     set.push_back(fmt::format("cloth.areal_density_kg_per_m2={}", dice.between(0.1, 0.5)));
                     if (std::strstr(name, "hang") == nullptr)
                       set.push_back(
                           fmt::format("material.membrane_stiffness_N_per_m={}", dice.log_between(500, 4000)));
                     if (std::strcmp(name, "paper/gravity") != 0)
                       set.push_back(fmt::format("material.damping_per_s={}", dice.between(0, 0.5)));
                     return load_scene(name, set);
                   }});
}

/// A cloth that falls on a plate, a bar or a needle, level or tilted.
void add_thin(std::vector<Kind>& out) {
  for (const char* name : {"plate", "bar", "needle"})
    out.push_back({name, [own = std::string(name)](std::uint64_t seed) {
                     Dice dice(seed, own);
                     json scene = json::parse(read_text(find_scenario("contact/box")));
                     const double thin = own == "needle" ? dice.between(0.003, 0.008) : dice.between(0.01, 0.05);
                     const double wide = own == "plate" ? dice.between(0.3, 0.6) : thin, turn = dice.between(0, 180);
                     const double length = dice.between(0.5, 0.9), tilt = dice.between(-20, 20);
                     json& box = scene["colliders"][0];
                     box["size_m"] = {length, thin, wide};
                     box["rotation_deg"] = {0, turn, tilt};
                     box["friction"] = dice.between(0.2, 0.8);
                     box["margin_m"] = std::min(0.004, thin / 4);
                     // The cloth starts above the highest corner of the box.
                     const double top = thin / 2 +
                                        (length + wide) / 2 * std::abs(std::sin(tilt * std::numbers::pi / 180)) +
                                        dice.between(0.05, 0.4);
                     scene["cloth"]["pose"]["center_m"] = {dice.between(-0.05, 0.05), top, dice.between(-0.05, 0.05)};
                     scene["cloth"]["sides"] = "double";
                     scene["time"]["duration_s"] = 1.2;
                     scene["name"] = own + "-drop";
                     scene["expect"] = json::object({{"outcome", "ok"}});
                     std::vector<std::string> set = {grid_of(dice)};
                     set.push_back(rate_of(dice));
                     return scene_from_json(scene, own, set);
                   }});
}

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all = [] {
    std::vector<Kind> out;
    add_drawn(out);
    add_files(out);
    add_thin(out);
    return out;
  }();
  return all;
}

}  // namespace

Vec3 Motion::at(std::size_t frame, std::size_t vertex) const {
  const float* x = position.data() + 3 * (frame * vertices() + vertex);
  return {x[0], x[1], x[2]};
}

void Motion::put(std::size_t frame, std::size_t vertex, const Vec3& x) {
  float* to = position.data() + 3 * (frame * vertices() + vertex);
  for (std::size_t i = 0; i < 3; ++i) to[i] = static_cast<float>(x[i]);
}

const std::vector<std::string>& scene_kinds() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> out;
    for (const Kind& k : kinds()) out.push_back(k.name);
    return out;
  }();
  return names;
}

Scene draw_scene(const std::string& kind, std::uint64_t seed) {
  for (const Kind& k : kinds())
    if (k.name == kind) return k.draw(seed);
  throw Error("liars: no kind of scene has this name");
}

std::string RightSolver::label() const {
  const json settings = json::parse(settings_json);
  return settings.contains("quality") ? name + " " + settings["quality"].get<std::string>() : name;
}

std::vector<RightSolver> right_solvers(const Scene& scene, const std::string& only) {
  std::vector<RightSolver> out;
  const auto add = [&](bool right, RightSolver with) {
    if (only.empty() ? !right : with.label() != only) return;
    for (const SolverEntry& entry : solvers())
      if (entry.info.name == with.name && unsupported(entry.info, scene.needs).empty() &&
          !(entry.info.on_gpu && entry.devices().empty()))
        out.push_back(with);
  };
  // Bullet satisfies neither friction nor thin bodies, and its soft bodies rebound. They also compute velocities from
  // positions in single precision: after a fall of 70 m, forces are off by a tenth of the weight.
  const bool alone = scene.colliders.empty() && scene.motion.empty(), pinned = !scene.pins.vertices.empty();
  add(true, {"xpbd", R"({"quality": "accurate"})"});
  add(true, {"reference", "{}"});
  add(alone && pinned, {"bullet-soft", "{}"});
  add(alone, {"bullet-deformable", "{}"});
  return out;
}

std::optional<Motion> run(const std::shared_ptr<const Scene>& scene, const RightSolver& with,
                          const std::function<void(Scene&)>& changed) {
  Scene given = *scene;
  if (changed) {
    changed(given);
    given.needs = derive_needs(given);
  }
  const SolverEntry& entry = find_solver(with.name);
  const std::unique_ptr<ClothSolver> solver =
      entry.make(complete_settings(entry.info, json::parse(with.settings_json)), {});
  solver->load(given);
  solver->reset();
  Motion out{scene, with.label(), {}, {}, {}};
  ClothState state;
  const auto keep = [&](int frame) {
    solver->read_state(state);
    out.time_s.push_back(scene->time.at(frame));
    for (const double x : state.position) out.position.push_back(static_cast<float>(x));
  };
  keep(0);
  for (int f = 0; f < scene->time.frames(); ++f) {
    if (solver->step({f, scene->time.at(f + 1), scene->time.dt_after(f), given.motion_after(f)}) != StepStatus::Ok)
      return std::nullopt;
    keep(f + 1);
  }
  out.contact_offsets_m = solver->plan().contact_margins_m;
  if (changed) out.contact_offsets_m.clear();
  return out;
}

}  // namespace clothbench::liars
