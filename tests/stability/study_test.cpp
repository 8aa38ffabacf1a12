// The study's driver with a solver of its own in a child: crashes, resume; and what a report makes of them.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <set>

#include "base/json_text.hpp"
#include "clothbench/error.hpp"
#include "report/view.hpp"
#include "results/store.hpp"
#include "runner/study_plan.hpp"
#include "scenario/load.hpp"
#include "with_folder.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

using StabilityStudy = WithFolder;

void write(const fs::path& file, const json& j) { std::ofstream(file) << j.dump(); }

/// Runs a study whose solvers only the child has.
void execute(const Study& study, const RunOptions& o) {
  static std::map<std::string, SolverEntry> entries;
  const RunPlan plan = plan_study(study, [](const std::string& name) -> const SolverEntry* {
    SolverEntry& e = entries[name];
    e.info.name = name;
    e.make = [](const json&, const DeviceOptions&) -> std::unique_ptr<ClothSolver> { return nullptr; };
    return &e;
  });
  execute_in_worker(plan, o);
}

TEST_F(StabilityStudy, RunsEveryRunAndOneCrashIsOneRow) {
  // The falling stone of the child is out of all bounds once its cloth starts faster than ten times a fall.
  write(dir_ / "thrown.json", {{"name", "thrown"},
                               {"why", "thrown ever faster in a test"},
                               {"cloth",
                                {{"grid", {3, 3}},
                                 {"size_m", {1, 1}},
                                 {"areal_density_kg_per_m2", 0.2},
                                 {"sides", "single"},
                                 {"start", {{"shape", "rest"}, {"noise_m", 1e-6}}}}},
                               {"material", {{"membrane_stiffness_N_per_m", 1000}}},
                               {"gravity_m_per_s2", {0, -1, 0}},
                               {"time", {{"frame_rate_hz", 60}, {"duration_s", 0.5}}},
                               {"stability", {{"case", "S16"}, {"judged", {"F0", "F1", "F2"}}}}});
  write(dir_ / "thrown-study.json",
        {{"name", "thrown"},
         {"why", "thrown in a test"},
         {"protocol", "stability-map"},
         {"scenes", {{{"file", "thrown.json"}}}},
         {"solvers", {{{"solver", "falls"}}, {{"solver", "crashes"}}}},
         {"trials", 1},
         {"run_limit_s", 20},
         {"rules", {{"frames", 0}, {"max_wall_s", 0}, {"min_frames", 1}, {"warmup_s", 0}}}});
  const Study study = load_study((dir_ / "thrown-study.json").string());
  RunOptions o;
  o.out = dir_ / "out";
  o.program = FAULTY_CHILD;
  fs::create_directories(o.out);
  execute(study, o);
  EXPECT_THROW(execute(study, o), Error);
  o.resume = true;
  execute(study, o);
  std::vector<RunRecord> runs;
  for (const auto& entry : fs::directory_iterator(dir_ / "out"))
    if (entry.path().extension() == ".h5" || entry.path().extension() == ".cbor")
      runs.push_back(read_run_summary(entry.path()));
  ASSERT_EQ(runs.size(), 2u);
  const RunTable rows(runs);
  for (const Row& r : rows.rows()) EXPECT_EQ(r.part, Part::Stability);
  std::vector<Table> tables;
  for (const View& v : views())
    if (v.section == "stability" || v.section == "failed")
      for (Table& t : tables_of(v, rows)) tables.push_back(std::move(t));
  ASSERT_EQ(tables.size(), 2u);
  const Table& table = tables[0];
  ASSERT_EQ(table.rows.size(), 3u);  // header, S16, all
  for (std::size_t k = 1; k < 3; ++k)
    EXPECT_EQ(table.rows[1][k], table.rows[0][k] == "falls" ? "1/1 stable" : "0/1 stable, 1 failed (F3)");
  ASSERT_EQ(tables[1].rows.size(), 2u);
  EXPECT_NE(tables[1].rows[1][1].find("crashed"), std::string::npos);
}

TEST(StabilityCases, AreAllThereAndLoad) {
  std::set<std::string> cases;
  std::size_t full = 0;
  for (const StudyLength length : {StudyLength::Quick, StudyLength::Full}) {
    const Study study = load_study("stability", {{}, length});
    full = study.scenes.size();
    for (const Study::Item& item : study.scenes) {
      EXPECT_FALSE(item.scene.stability.name.empty()) << item.scene.name;
      EXPECT_NE(item.scene.stability.judged & 1u, 0u) << item.scene.name << " does not judge F0";
      cases.insert(item.scene.stability.name);
      const std::string number = item.scene.name.substr(1, 2);
      EXPECT_EQ(item.scene.stability.name, "S" + number) << item.scene.name;
      // A separate process receives the scene that --resume looks for.
      if (length == StudyLength::Quick) {
        EXPECT_EQ(scene_from_json(json::parse(item.scene.json), item.scene.source).sha256, item.scene.sha256)
            << item.scene.name;
      }
    }
  }
  EXPECT_EQ(cases.size(), 26u);
  EXPECT_GE(full, 140u);
}

}  // namespace
}  // namespace clothbench
