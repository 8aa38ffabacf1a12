// Scenes for planted faults: each needs a part of the solver, or has a value that is known in advance.
#include <fmt/format.h>

#include "../metrics/prescribed_solver.hpp"
#include "scenario/load.hpp"
#include "trial.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

Stage solved(const std::string& name, Scene scene, int trials = 0) {
  return {name, std::move(scene), find_solver("xpbd"), trials};
}

Stage stage_of(const std::string& name, const std::string& scene, Path path) {
  return {name, scene_from_json(json::parse(scene), "planted/" + name), prescribed(std::move(path)), 0};
}

Scene scene(const std::string& text) { return scene_from_json(json::parse(text), "planted"); }

/// capstan-slip with 12 rows on the cylinder, for speed: cells of 2 R sin(pi/24).
const std::vector<std::string> kCoarseCapstan = {"cloth.grid=[52,5]",
                                                 "cloth.size_m=[1.331367160644526,0.10442095377604127]",
                                                 "cloth.pose.drape.offset_m=0.3132628613281238"};

/// A level cloth of 0.5 m over an open sheet of 200 triangles.
Scene over_tiles() {
  std::string positions, corners;
  for (int j = 0; j <= 10; ++j)
    for (int i = 0; i <= 10; ++i)
      positions += fmt::format("{}[{},0,{}]", positions.empty() ? "" : ",", 0.06 * i - 0.3, 0.06 * j - 0.3);
  for (int j = 0; j < 10; ++j)
    for (int i = 0; i < 10; ++i) {
      const int v = 11 * j + i;
      corners +=
          fmt::format("{}[{},{},{}],[{},{},{}]", corners.empty() ? "" : ",", v, v + 11, v + 12, v, v + 12, v + 1);
    }
  return scene(fmt::format(R"({{"name":"tiles","why":"Falls flat onto an open sheet of 200 triangles.",
    "cloth":{{"grid":[31,31],"size_m":[0.5,0.5],"areal_density_kg_per_m2":0.2,"sides":"double","initial_velocity_m_per_s":[0,-2,0],"pose":{{"center_m":[0.003,0.05,0.002]}}}},
    "material":{{"membrane_stiffness_N_per_m":1000,"bending_rigidity_N_m":1e-5,"damping_per_s":0.1}},
    "colliders":[{{"type":"mesh","positions_m":[{}],"triangles":[{}],"margin_m":0.001,"friction":0.3}}],
    "time":{{"frame_rate_hz":72,"duration_s":0.4}},"expect":{{"outcome":"ok","crossings_max":{{"at_most":0}}}}}})",
                           positions, corners));
}

const char* const kPushed = R"({"name":"pushed","why":"A capsule pushes a hanging cloth out of its plane and along it.",
  "cloth":{"grid":[17,17],"size_m":[0.5,0.5],"areal_density_kg_per_m2":0.2,"sides":"double","pose":{"axis_u":[1,0,0],"axis_v":[0,-1,0]}},
  "material":{"membrane_stiffness_N_per_m":1000,"bending_rigidity_N_m":1e-5,"damping_per_s":0.1},"pins":[{"edge":"v0"}],
  "colliders":[{"type":"capsule","center_m":[0.05,0,0.08],"axis":[0,1,0],"length_m":0.2,"radius_m":0.03,"velocity_m_per_s":[-0.1,0,-0.6],"stop_s":0.3,"friction":0.3}],
  "time":{"frame_rate_hz":72,"duration_s":0.4},
  "expect":{"outcome":"ok","depth_max_m":{"at_most":0.001},"crossings_max":{"at_most":0}}})";

// Contact with so few substeps that responses do not suffice and planes must keep the cloth out: a corner of a box, and
// a fingertip that rises through the inside of a cell.
const char* const kStruck = R"({"name":"struck","why":"A sheet is thrown onto a box and a fingertip that comes up.",
  "cloth":{"grid":[17,17],"size_m":[0.5,0.5],"areal_density_kg_per_m2":0.2,"sides":"double","initial_velocity_m_per_s":[0.9,-4,0.3],"pose":{"center_m":[0.003,0.14,0.002]}},
  "material":{"membrane_stiffness_N_per_m":1000,"damping_per_s":0.1},
  "colliders":[{"type":"box","center_m":[-0.1,0,-0.05],"size_m":[0.15,0.1,0.2],"margin_m":0.004,"friction":0.5},
    {"type":"capsule","center_m":[0.122,-0.1,0.113],"axis":[0,1,0],"length_m":0.1,"radius_m":0.007,"velocity_m_per_s":[0,4,0],"stop_s":0.08,"margin_m":0.004,"friction":0.3}],
  "time":{"frame_rate_hz":72,"duration_s":0.3},
  "expect":{"outcome":"ok","depth_max_m":{"at_most":1e-5}}})";

// Self-contact: a folded cloth is thrown down with so few substeps that only planes keep its layers apart.
const char* const kHeaped = R"({"name":"heaped","why":"A folded sheet is thrown onto the floor and onto itself.",
  "cloth":{"grid":[17,17],"size_m":[0.5,0.5],"areal_density_kg_per_m2":0.2,"sides":"double","initial_velocity_m_per_s":[0.6,-5,0.4],
           "pose":{"center_m":[0,0.1,0],"axis_u":[0,1,0],"axis_v":[0,0,1],"drape":{"radius_m":0.04}},"start":{"shape":"rest","noise_m":0.001,"seed":8},
           "self_collision":{"thickness_m":0.006,"friction":0.5}},
  "material":{"membrane_stiffness_N_per_m":1000,"damping_per_s":0.1},"colliders":[{"type":"plane","point_m":[0,0,0],"margin_m":0.004,"friction":0.3}],
  "time":{"frame_rate_hz":72,"duration_s":0.3},
  "expect":{"outcome":"ok","self_contact_pairs_max":{"at_most":0}}})";

const char* const kPulled = R"({"name":"pulled","why":"Two bars pull a sheet apart and let go.",
  "cloth":{"grid":[17,9],"size_m":[0.5,0.25],"areal_density_kg_per_m2":0.2,"sides":"single","pose":{}},
  "material":{"membrane_stiffness_N_per_m":1000},"gravity_m_per_s2":[0,0,0],
  "grips":[{"edge":"u0","velocity_m_per_s":[-0.5,0,0],"stop_s":0.2},{"edge":"u1","velocity_m_per_s":[0.5,0,0],"stop_s":0.2}],
  "time":{"frame_rate_hz":72,"duration_s":0.4},
  "expect":{"outcome":"ok","grip_edge_ratio_max":{"at_most":1.25},"grip_error_max_m":{"at_most":1e-6}}})";

// R = 0.1 m, d = 0.01 m in the last frame: contour 2 pi sqrt(2Rd - d^2), up to 1 % of R further inside.
const char* const kPressed = R"({"name":"pressed","why":"A sheet pushed into a sphere.",
  "cloth":{"grid":[65,65],"size_m":[0.24,0.24],"areal_density_kg_per_m2":0.2,"sides":"double","pose":{"center_m":[0,0.2,0]}},
  "material":{"membrane_stiffness_N_per_m":1000},"colliders":[{"type":"sphere","center_m":[0,0,0],"radius_m":0.1}],
  "time":{"frame_rate_hz":20,"duration_s":1},
  "expect":{"outcome":"ok","depth_max_m":{"at_least":0.0099,"at_most":0.0101},"contact_length_max_m":{"at_least":0.2615,"at_most":0.2739}}})";

// A capsule rises into a static sheet: 0.01 m deep in the last frame, 5 mm less in the frame before.
const char* const kRising = R"({"name":"rising","why":"A capsule comes up into a static sheet.",
  "cloth":{"grid":[25,25],"size_m":[0.24,0.24],"areal_density_kg_per_m2":0.2,"sides":"double","pose":{}},
  "material":{"membrane_stiffness_N_per_m":1000},
  "colliders":[{"type":"capsule","center_m":[0,-0.24,0],"axis":[0,0,1],"length_m":0.1,"radius_m":0.1,"velocity_m_per_s":[0,0.3,0]}],
  "time":{"frame_rate_hz":60,"duration_s":0.5},
  "expect":{"outcome":"ok","depth_max_m":{"at_least":0.0099,"at_most":0.0101}}})";

// The right half is folded over the left half; in the last frame they cross along one line, as long as the width.
const char* const kCrossed = R"({"name":"crossed","why":"A sheet laid over itself and through.",
  "cloth":{"grid":[17,9],"size_m":[1,0.5],"areal_density_kg_per_m2":0.2,"sides":"double","pose":{},"self_collision":{"thickness_m":0.002}},
  "material":{"membrane_stiffness_N_per_m":1000},"time":{"frame_rate_hz":20,"duration_s":1},
  "expect":{"outcome":"ok","self_contact_length_max_m":{"at_least":0.4999,"at_most":0.5001}}})";

void lay_over(int frame, std::vector<double>& x) {
  for (std::size_t v = 0; v < x.size(); v += 3) {
    const double u = x[v] + 0.5;
    if (u <= 0.5) continue;
    x[v] = 0.5 - u;
    x[v + 1] += 0.05 - (frame == 20 ? 0.26 * (u - 0.5) : 0);
  }
}

double down(int frame, double from, double to, int frames) { return -(from + (to - from) * frame / frames); }

}  // namespace

std::vector<Stage> stages() {
  std::vector<Stage> out;
  out.push_back(solved("fall", load_scene("paper/gravity", {"cloth.grid=[9,9]", "time.duration_s=0.75"}), 2));
  out.push_back(
      solved("undamped",
             load_scene("paper/gravity", {"cloth.grid=[9,9]", "time.duration_s=0.5", "material.damping_per_s=0"}), 2));
  out.push_back(solved("swing", load_scene("validation/swing-strip")));
  out.push_back(solved("cantilever", load_scene("validation/cantilever-10", {"time.duration_s=2"})));
  out.push_back(solved("heavy", load_scene("validation/heavy-strip", {"time.duration_s=2"})));
  out.push_back(solved("slope", load_scene("validation/incline-slip")));
  out.push_back(solved(
      "ramp",
      load_scene(
          "validation/incline-slip",
          {R"(colliders=[{"type":"plane","point_m":[0,0,0],"normal":[0.3007057995042731,0.9537169507482269,0],"margin_m":0.004,"friction":0.3}])"})));
  out.push_back(solved("ball", load_scene("contact/sphere", {"cloth.grid=[17,17]", "time.duration_s=1",
                                                             "cloth.pose.center_m=[0,0.2,0]"})));
  out.push_back(solved("tiles", over_tiles()));
  out.push_back(solved("pushed", scene(kPushed)));
  out.push_back(solved("struck", scene(kStruck)));
  out.back().settings = {{"substeps", 3}};
  out.push_back(solved("heaped", scene(kHeaped)));
  out.back().settings = {{"substeps", 2}};
  out.push_back(solved("wrapped", load_scene("validation/capstan-slip", kCoarseCapstan)));
  out.back().settings = {{"substeps", 16}};
  out.push_back(solved("pulled", scene(kPulled)));
  out.push_back(stage_of("crossed", kCrossed, lay_over));
  out.push_back(stage_of("pressed", kPressed, lifted([](int f) { return down(f, 0, 0.11, 20); })));
  out.push_back(stage_of("rising", kRising, [](int, std::vector<double>&) {}));
  return out;
}

}  // namespace clothbench
