// Motions on the page: which runs get one, how many frames it has, and how it is packed.
#include <zlib.h>

#include <Eigen/Geometry>
#include <bit>
#include <map>
#include <tuple>

#include "assets/base64.hpp"
#include "clothbench/error.hpp"
#include "report/web/page.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

constexpr std::size_t kMostOfScene = 6;  // the viewer shows at most six side by side
constexpr std::size_t kMostFrames = 150;
constexpr double kMostGrowth = 20;  // relative to the cloth's initial extent; larger cloth shows nothing

/// zlib of a text, or of words, which are little-endian on all supported machines.
template <class Words>
std::string deflated(const Words& words) {
  const uLong bytes = words.size() * sizeof(words[0]);
  uLongf size = compressBound(bytes);
  std::string out(size, '\0');
  const int status =
      compress2(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(words.data()), bytes, 6);
  if (status != Z_OK) throw Error("zlib: compress2 failed with " + std::to_string(status), ExitCode::CheckFailed);
  out.resize(size);
  return out;
}

std::string base64_of(const std::string& bytes) {
  return assets::encode_base64(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

/// Rows with a trajectory, most important for the page first: the first leading scene, garments with contact, other
/// leading scenes, other and random scenes with contact, scenes without contact; last, runs without a cloth model.
/// Within each group: default settings first; each solver's first row before any second row. At most six per scene.
std::vector<const Row*> candidates(const RunTable& table) {
  std::vector<std::pair<std::tuple<bool, std::size_t, bool, std::size_t>, const Row*>> order;
  std::map<std::pair<std::string, std::string>, std::size_t> of_solver;
  std::map<std::string, std::size_t> of_scene;
  for (const Row& r : table.rows()) {
    if (r.run->file.empty() || r.run->accuracy.time_s.empty()) continue;
    const bool contact = r.contact && r.part != Part::Truth, garment = r.resolution.grid[0] == 0;
    const std::size_t scenes = leading_scenes().size(), at = r.drawn().is_null() ? place_of_scene(r.scene) : scenes;
    const std::size_t place = !contact ? 2 * scenes + 1 : garment ? 1 : 2 * at;
    order.push_back({{is_floor(r.solver), place, r.setting != "default", of_solver[{r.scene, r.solver}]++}, &r});
  }
  std::stable_sort(order.begin(), order.end(), [](auto& a, auto& b) { return a.first < b.first; });
  std::vector<const Row*> out;
  for (const auto& [unused, row] : order)
    if (++of_scene[row->scene] <= kMostOfScene) out.push_back(row);
  return out;
}

struct Packer {
  std::size_t left_B;
  std::vector<std::string> blobs = {};
  std::vector<json> runs = {}, colliders = {};
  std::map<std::string, std::size_t> scenes = {};  ///< hash of a scenario -> index into colliders

  /// Adds the motion of a row; false if the budget is exhausted or the initial cloth is not finite.
  bool add(const Row& r, std::size_t index) {
    const RunRecord& c = *r.run;
    const std::size_t stride = 1 + c.accuracy.time_s.size() / kMostFrames;
    // Six bytes per vertex, compressed to a twentieth at best: a motion that cannot fit is not read.
    if (c.accuracy.time_s.size() / stride * c.header.vertices * 6 / 20 > left_B) return false;
    const Replay replay = read_replay(c.file, stride);
    const PackedMotion motion = pack_motion(replay);
    if (motion.frames.empty() || motion.bytes.size() * 4 / 3 > left_B) return false;
    json time_s = json::array(), metrics = json::object();
    for (std::size_t f = 0; f < motion.frames.size(); ++f) time_s.push_back(replay.time_s[f]);
    for (const MetricSeries& m : c.accuracy.metrics) {
      if (m.name != "stretch_max" && m.name != "contact_length_m" && m.name != "depth_m") continue;
      for (const std::size_t f : motion.frames)
        metrics[m.name].push_back(rounded(f < m.values.size() ? m.values[f] : kMissing));
    }
    json e = {{"run", index},
              {"frames_stored", c.accuracy.time_s.size()},
              {"frames", motion.frames},
              {"time_s", std::move(time_s)},
              {"step_m", motion.step_m},
              {"low_m", motion.low_m},
              {"cut_at", motion.cut_at},
              {"metrics", std::move(metrics)},
              {"colliders", colliders_of(c, replay.groups)},
              {"blob", blob(motion.bytes)}};
    if (r.resolution.grid[0] > 0)
      e["grid"] = r.resolution.grid;
    else
      e["triangles"] = blob(deflated(c.header.triangles));
    runs.push_back(std::move(e));
    return true;
  }

  std::size_t blob(const std::string& bytes) {
    blobs.push_back(base64_of(bytes));
    left_B -= std::min(left_B, blobs.back().size());
    return blobs.size() - 1;
  }

  /// Index of the scene's colliders and grips in the page's list.
  std::size_t colliders_of(const RunRecord& c, std::vector<StoredGroup> groups) {
    const auto [at, is_new] = scenes.try_emplace(c.header.scenario_sha256, colliders.size());
    if (!is_new) return at->second;
    std::erase_if(groups, [](const StoredGroup& g) { return !g.path.starts_with("colliders"); });
    json described = json::array();
    for (StoredGroup& g : groups) {
      try {
        show_shape(g);
      } catch (const json::exception& error) {
        throw Error(c.file + ": /" + g.path + ": " + error.what());
      }
      json arrays = json::object();
      for (const StoredArray& a : g.arrays) {
        std::vector<std::uint32_t> words;
        for (const double v : a.values)
          words.push_back(a.integer ? static_cast<std::uint32_t>(v)
                                    : std::bit_cast<std::uint32_t>(static_cast<float>(v)));
        arrays[a.name] = {{"shape", a.shape}, {"integer", a.integer}, {"blob", blob(deflated(words))}};
      }
      described.push_back({{"path", g.path}, {"attributes", g.attributes}, {"arrays", std::move(arrays)}});
    }
    colliders.push_back(std::move(described));
    return at->second;
  }
};

}  // namespace

std::string packed(const json& j) { return base64_of(deflated(dump(j, -1, true, json::error_handler_t::replace))); }

PackedMotion pack_motion(const Replay& replay) {
  PackedMotion out;
  if (replay.frames.empty()) return out;
  const std::size_t vertices = replay.position.size() / 3 / replay.frames.size(), size = 3 * vertices;
  Eigen::AlignedBox3d all;
  double first = 0;
  for (std::size_t f = 0; f < replay.frames.size(); ++f) {
    const Eigen::Map<const Eigen::Matrix3Xf> x(&replay.position[size * f], 3, static_cast<Eigen::Index>(vertices));
    Eigen::AlignedBox3d box;  // empty if a position is not finite
    if (vertices > 0 && x.allFinite())
      box = Eigen::AlignedBox3f(x.rowwise().minCoeff(), x.rowwise().maxCoeff()).cast<double>();
    if (box.isEmpty() || (f > 0 && box.sizes().maxCoeff() > kMostGrowth * first)) {
      out.cut_at = static_cast<long>(replay.frames[f]);
      break;
    }
    if (f == 0) first = box.sizes().maxCoeff();
    all.extend(box);
    out.frames.push_back(replay.frames[f]);
  }
  if (out.frames.empty()) return out;
  for (int a = 0; a < 3; ++a) out.low_m[a] = all.min()[a];
  const double extent = all.sizes().maxCoeff();
  out.step_m = extent > 0 ? extent / 65535 : 1;
  std::vector<std::uint16_t> q, residuals;
  for (std::size_t f = 0; f < out.frames.size(); ++f)
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t v = 0; v < vertices; ++v) {
        const std::size_t k = q.size();
        q.push_back(static_cast<std::uint16_t>(
            std::lround((replay.position[size * f + 3 * v + a] - out.low_m[a]) / out.step_m)));
        const int predicted = f > 1 ? 2 * q[k - size] - q[k - 2 * size] : f == 1 ? q[k - size] : k > 0 ? q[k - 1] : 0;
        residuals.push_back(static_cast<std::uint16_t>(q[k] - predicted));
      }
  out.bytes = deflated(residuals);
  return out;
}

Motions motions_of(const RunTable& table, std::size_t budget_B) {
  Packer all{budget_B};
  std::size_t left_out = 0;
  for (const Row* r : candidates(table)) left_out += !all.add(*r, static_cast<std::size_t>(r - table.rows().data()));
  const json first = all.runs.empty() ? json() : all.runs.front()["run"];
  std::sort(all.runs.begin(), all.runs.end(), [](const json& a, const json& b) { return a["run"] < b["run"]; });
  return {{{"first", first}, {"runs", all.runs}, {"colliders", all.colliders}, {"left_out", left_out}}, all.blobs};
}

}  // namespace clothbench
