// Settings of `xpbd`.
#include "common/gpu_solver.hpp"

namespace clothbench::pbd_gpu {
namespace {

/// A member of the setting `tuning`: its values, the default first, and what it decides.
struct Tuning {
  const char* name;
  std::vector<nlohmann::json> values;
  const char* doc;
};

const std::vector<Tuning>& tunings() {
  static const std::vector<Tuning> all = {
      {"contact_frame", {"auto", "always", "never"}, "frames with contact in one dispatch; auto: if that is faster"},
      {"device_barrier",
       {"auto", "always", "never"},
       "workgroups of a dispatch wait for one another; auto: on discrete GPUs that run all of them at once"},
      {"bdf2", {"auto", "always"}, "time_order 2; auto: if it is safe, always: in every scene without contact"},
      {"tension", {"auto", "always", "never"}, "implicit tension; auto: where it helps, always: contact-free scenes"},
      {"splitting_correction", {"auto", "always", "never"}, "for diagonals; auto: in sheets whose modulus needs it"},
      {"vertices_a_thread", {0, 2, 4, 8, 16, 32}, "vertices of a line per thread; 0: by line and device"},
      {"threads_a_group", {0, 32, 64, 128, 256, 512, 1024}, "threads per workgroup; 0: by line and device"},
      {"lines_beside", {0, 1, 2, 4}, "neighbouring lines whose threads are interleaved; 0: by line and device"}};
  return all;
}

}  // namespace

SolverInfo xpbd_info() {
  SolverInfo info;
  info.name = "xpbd";
  info.folder = "solvers/pbd-gpu";
  info.summary = "extended PBD in small steps with a direct solve of each grid line, and tethers; bitwise repeatable";
  info.version = "2";
  info.precision = "float32";
  info.time_order = 2;
  info.on_gpu = true;
  info.supports = {Feature::Stretch,  Feature::Shear,       Feature::Bend,         Feature::Damping,
                   Feature::Pins,     Feature::MovingPins,  Feature::Sphere,       Feature::Box,
                   Feature::Plane,    Feature::Capsules,    Feature::StaticMesh,   Feature::MovingMesh,
                   Feature::Friction, Feature::DoubleSided, Feature::Spin,         Feature::UnevenGrid,
                   Feature::Regions,  Feature::ClothMesh,   Feature::SelfCollision};
  info.settings = {{"quality", "\"default\"",
                    "fast, default, accurate: substeps for the resolution, material, contact, attachments"},
                   {"substeps", "0", "substeps per frame; 0: by quality"},
                   {"time_order", "2", "2: BDF2 in scenes without contact where that is safe; 1: backward Euler"},
                   {"tethers", "true",
                    "limit the distance of vertices from pinned ones (long-range attachments), where that is correct"},
                   {"stage_times", "false", "timestamps around every stage (slower; for profiling)"},
                   {"count_bytes", "false", "kernels count the bytes that they load and store (slower)"}};
  info.tuning = {
      {"contact_groups", "0", "minimum workgroups of a fused frame with contact; 0: 96, or as many as the lines need"},
      {"contact_pairs", "0", "capacity of the list of pairs; 0: by the number of the cloth's primitives"}};
  for (const Tuning& t : tunings()) info.tuning.push_back({t.name, dump(t.values.front()), t.doc});
  return info;
}

void check_xpbd_settings(const nlohmann::json& settings) {
  require_between("xpbd", settings, "substeps", 0, 4096);
  require_one_of("xpbd", settings, "quality", {"fast", "default", "accurate"});
  require_between("xpbd", settings, "time_order", 1, 2);
  const nlohmann::json& tuning = settings[kTuning];
  for (const Tuning& t : tunings()) require_one_of("xpbd", tuning, t.name, t.values);
  require_between("xpbd", tuning, "contact_groups", 0, 1024);
  require_between("xpbd", tuning, "contact_pairs", 0, 1 << 24);
}

}  // namespace clothbench::pbd_gpu
