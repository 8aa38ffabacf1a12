// Which motions the viewer gets, and how much of each.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "clothbench/error.hpp"
#include "report/web/page.hpp"
#include "results/replay.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

constexpr std::size_t kMostRuns = 120;
constexpr std::size_t kMostFloats = 40'000'000;     // of one run in memory: 160 MB
constexpr std::size_t kMostCollider_B = 3'000'000;  // of one scene's colliders, packed

/// Coarser from line to line: frames first, as between them the viewer interpolates.
struct Level {
  std::size_t frame_stride, most_width;
};
constexpr Level kLevels[] = {{1, 65}, {2, 65}, {3, 65},  {4, 65},  {4, 33},
                             {6, 33}, {8, 33}, {12, 33}, {12, 17}, {24, 17}};

struct Candidate {
  const RunRecord* run = nullptr;
  json scenario;
  std::size_t columns = 0, rows = 0;  // of a mesh: its vertices and 1
  bool mesh = false;
  int rank = 0;
  std::size_t turn = 0;  // among those of its scene, solver and rank
};

/// Order in which runs get a place on the page.
int rank_of(const RunRecord& c) {
  if (has_contact(c) && !has_truth(c)) return 0;
  return c.header.setting == "default" ? 1 : 2;
}

std::vector<Candidate> candidates(const std::vector<RunRecord>& runs, std::size_t& without) {
  std::vector<Candidate> out;
  std::map<std::tuple<int, std::string, std::string>, std::size_t> turns;
  for (const RunRecord& c : runs) {
    if (c.file.empty() || c.accuracy.time_s.empty()) continue;
    Candidate k{&c, scenario_of(c)};
    const json grid = k.scenario.is_object() ? k.scenario.value(json::json_pointer("/cloth/grid"), json()) : json();
    if (grid.is_array() && grid.size() == 2 && grid[0].is_number_unsigned() && grid[1].is_number_unsigned()) {
      k.columns = grid[0];
      k.rows = grid[1];
    }
    if (k.scenario.is_object() && k.scenario.contains(json::json_pointer("/cloth/mesh"))) {
      k.mesh = true;
      k.columns = c.header.vertices;
      k.rows = 1;
    }
    if (!(k.mesh ? c.header.triangles.size() >= 3 : k.columns >= 2 && k.rows >= 2) ||
        k.columns * k.rows != c.header.vertices) {
      ++without;
      continue;
    }
    k.rank = rank_of(c);
    k.turn = turns[{k.rank, c.header.scene, c.header.solver}]++;
    out.push_back(std::move(k));
  }
  // Every solver's first run of each scene comes before any second.
  std::stable_sort(out.begin(), out.end(), [](const Candidate& a, const Candidate& b) {
    return std::pair(a.rank, a.turn) < std::pair(b.rank, b.turn);
  });
  return out;
}

class Packer {
 public:
  explicit Packer(std::size_t budget_B) : left_B_(budget_B) {
    out_.document = {{"runs", json::array()}, {"colliders", json::array()}, {"left_out", json::array()}};
  }

  /// The run's motion in at most its share of what is left; false if it does not fit even at the coarsest.
  bool add(const Candidate& k, std::size_t runs_left) {
    const std::size_t share = left_B_ / std::max<std::size_t>(runs_left, 1);
    const std::size_t frames = k.run->accuracy.time_s.size();
    for (const Level& level : kLevels) {
      if (frames / level.frame_stride * 3 * k.run->header.vertices > kMostFloats) continue;
      // A mesh keeps all of its vertices.
      const std::size_t width = std::max(k.columns, k.rows),
                        step = k.mesh ? 1 : (width + level.most_width - 1) / level.most_width;
      // Six bytes a vertex, deflated to a fifth at best: what is sure not to fit is not read.
      const std::size_t least_B = frames / level.frame_stride * (k.columns / step) * (k.rows / step) * 6 / 5;
      if (least_B > share) continue;
      const Replay replay = read_replay(k.run->file, level.frame_stride);
      const PackedMotion motion = pack_motion(replay, k.columns, k.rows, step);
      if (motion.frames.empty()) return false;
      if (const std::size_t size = (motion.bytes.size() + 2) / 3 * 4; size > share) continue;
      store(k, replay, motion);
      return true;
    }
    return false;
  }

  Motions take() { return std::move(out_); }
  json& left_out() { return out_.document["left_out"]; }

 private:
  std::size_t blob(const std::string& bytes) {
    out_.blobs.push_back(base64(bytes));
    left_B_ -= std::min(left_B_, out_.blobs.back().size());
    return out_.blobs.size() - 1;
  }

  void store(const Candidate& k, const Replay& replay, const PackedMotion& motion) {
    const RunRecord& c = *k.run;
    const auto size = [&](int axis) {
      return k.scenario.value(json::json_pointer(fmt::format("/cloth/size_m/{}", axis)), 0.0);
    };
    json time_s = json::array(), metrics = json::object();
    for (std::size_t f = 0; f < motion.frames.size(); ++f) time_s.push_back(replay.time_s[f]);
    for (const char* name : {"stretch_max", "contact_length_m", "depth_m"})
      for (const MetricSeries& m : c.accuracy.metrics)
        if (m.name == name) {
          json values = json::array();
          for (const std::size_t f : motion.frames)
            values.push_back(f < m.values.size() && std::isfinite(m.values[f])
                                 ? json(std::stod(fmt::format("{:.6g}", m.values[f])))
                                 : json());
          metrics[name] = std::move(values);
        }
    json e = {{"scene", c.header.scene},
              {"solver", c.header.solver},
              {"setting", c.header.setting},
              {"label", label_of(c)},
              {"sides", k.scenario.value(json::json_pointer("/cloth/sides"), "")},
              {"status", c.outcome.status},
              {"failed_frame", c.outcome.failed_frame},
              {"message", c.outcome.message},
              {"frames_stored", c.accuracy.time_s.size()},
              {"frames", motion.frames},
              {"time_s", std::move(time_s)},
              {"step_m", motion.step_m},
              {"origin", motion.origin},
              {"cut_at", motion.cut_at},
              {"metrics", std::move(metrics)}};
    if (k.mesh) {
      e["vertices"] = k.columns;
      e["triangles"] = blob(pack_words(c.header.triangles));
    } else {
      e["grid"] = {k.columns, k.rows};
      e["size_m"] = {size(0), size(1)};
      e["columns"] = motion.columns;
      e["rows"] = motion.rows;
    }
    if (const std::string which = colliders(c, replay.groups); !which.empty()) e["colliders"] = std::stoul(which);
    e["blob"] = blob(motion.bytes);
    out_.document["runs"].push_back(std::move(e));
  }

  /// Index of the colliders among those of the page, as text; "" if there are none or they are too large.
  std::string colliders(const RunRecord& c, std::vector<StoredGroup> groups) {
    std::erase_if(groups, [](const StoredGroup& g) { return !g.path.starts_with("colliders"); });
    if (groups.empty()) return "";
    json described = json::array();
    std::vector<std::string> packed;
    std::size_t total = 0;
    std::string key;
    for (StoredGroup& g : groups) {
      try {
        show_shape(g);
      } catch (const json::exception& e) {
        throw Error(c.file + ": /" + g.path + ": " + e.what());
      }
      json arrays = json::object();
      for (const StoredArray& a : g.arrays) {
        packed.push_back(a.integer ? pack_words({a.values.begin(), a.values.end()}) : pack_floats(a.values));
        total += packed.back().size();
        arrays[a.name] = {{"shape", a.shape}, {"integer", a.integer}};
      }
      described.push_back({{"path", g.path}, {"attributes", g.attributes}, {"arrays", std::move(arrays)}});
    }
    key = described.dump();
    for (const std::string& p : packed) key += '\n' + p;
    const auto [at, is_new] = seen_.try_emplace(key, "");
    if (!is_new) return at->second;
    if (total > kMostCollider_B) {
      left_out().push_back(
          fmt::format("The colliders of {}: {:.1f} MB.", c.header.scene, 1e-6 * static_cast<double>(total)));
      return "";
    }
    std::size_t next = 0;
    for (std::size_t g = 0; g < groups.size(); ++g)
      for (const StoredArray& a : groups[g].arrays) described[g]["arrays"][a.name]["blob"] = blob(packed[next++]);
    out_.document["colliders"].push_back(std::move(described));
    return at->second = std::to_string(out_.document["colliders"].size() - 1);
  }

  std::size_t left_B_;
  Motions out_;
  std::map<std::string, std::string> seen_;
};

}  // namespace

Motions motions_of(const std::vector<RunRecord>& runs, std::size_t budget_B) {
  std::size_t without_cloth = 0, too_large = 0, beyond = 0;
  std::vector<Candidate> all = candidates(runs, without_cloth);
  if (all.size() > kMostRuns) {
    beyond = all.size() - kMostRuns;
    all.resize(kMostRuns);
  }
  // Small ones first: what they leave of their share is for the others.
  std::stable_sort(all.begin(), all.end(), [](const Candidate& a, const Candidate& b) {
    const auto size = [](const Candidate& k) { return k.columns * k.rows * k.run->accuracy.time_s.size(); };
    return size(a) < size(b);
  });
  Packer packer(budget_B);
  for (std::size_t k = 0; k < all.size(); ++k) too_large += !packer.add(all[k], all.size() - k);
  const auto say = [&](std::size_t n, const char* why) {
    if (n > 0) packer.left_out().push_back(fmt::format("{} {} {}.", n, n == 1 ? "motion:" : "motions:", why));
  };
  say(beyond, "the page holds 120; motions of other settings are omitted first");
  say(too_large, "too large at the coarsest thinning, or not finite from the start");
  say(without_cloth, "its file has no triangles of its cloth");
  Motions out = packer.take();
  auto& shown = out.document["runs"];
  std::stable_sort(shown.begin(), shown.end(), [](const json& a, const json& b) {
    const auto key = [](const json& j) {
      return std::tuple(j["scene"].get<std::string>(), j["solver"].get<std::string>(), j["setting"].get<std::string>());
    };
    return key(a) < key(b);
  });
  return out;
}

}  // namespace clothbench
