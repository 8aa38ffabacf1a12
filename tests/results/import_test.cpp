// A run is executed and stored both ways: as a machine with HDF5 does, and as a device without it does, whose
// CBOR file is then imported. The two files are the same, byte for byte.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "clothbench/error.hpp"
#include "results/hdf5_file.hpp"
#include "results/replay.hpp"
#include "results/store.hpp"
#include "runner/solver_run.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

std::string bytes(const fs::path& p) {
  std::ifstream in(p, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

struct Case {
  std::string solver, scene;
};

std::string name_of(const Case& c) {
  std::string name = c.solver + "_" + fs::path(c.scene).stem().string();
  for (char& letter : name)
    if (letter == '-') letter = '_';
  return name;
}

/// For the runner's messages, which otherwise print bytes.
void PrintTo(const Case& c, std::ostream* out) { *out << name_of(c); }

class Import : public ::testing::TestWithParam<Case> {
 protected:
  void SetUp() override {
    dir_ = fs::temp_directory_path() / ("clothbench-import-" + std::to_string(getpid()) + "-" + name_of(GetParam()));
    for (const char* folder : {"direct", "device", "memory"}) fs::create_directories(dir_ / folder);
  }
  void TearDown() override { fs::remove_all(dir_); }
  fs::path dir_;
};

/// Hands everything over as the runner does.
fs::path store(const fs::path& dir, const RunRecord& r, Finish how) {
  RunWriter writer(dir, r.header, how);
  writer.write_replay(r.replay);
  if (!r.accuracy.time_s.empty()) writer.write_accuracy(r.accuracy);
  for (const TimedTrial& t : r.trials) writer.write_trial(t);
  return writer.finish(r.outcome, r.summary);
}

TEST_P(Import, GivesTheFileOfADirectRun) {
  const Scene scene = load_scene(GetParam().scene, {"cloth.grid=[9,7]", "cloth.sides=single"});
  const SolverEntry& entry = find_solver(GetParam().solver);
  RunRecord r;
  try {
    SolverRun run({&scene, &entry, complete_settings(entry.info, nlohmann::json::object()), "default"}, {}, "test");
    TrialRules rules;
    rules.warmup_s = 0;
    rules.accuracy_duration_s = 0.1;
    r.header = run.header();
    if (run.alive()) {
      r.replay = replay_of(scene);
      r.accuracy = run.run_accuracy(rules);
      for (int k = 0; k < 2; ++k) r.trials.push_back(run.run_trial(k, rules, 12));
    }
    r.outcome = run.outcome();
    r.summary = summarise(run.spec(), run.plan(), r);
  } catch (const Error& e) {
    const char* allowed = std::getenv("CLOTHBENCH_ALLOW_NO_DEVICE");
    if (e.code() == ExitCode::NoDevice && allowed != nullptr && std::string(allowed) == "1") GTEST_SKIP() << e.what();
    FAIL() << e.what();
  }
  ASSERT_TRUE(r.outcome.status == "ok" || r.outcome.status == "unsupported") << r.outcome.message;
  EXPECT_EQ(r.replay.empty(), scene.colliders.empty() || r.outcome.status == "unsupported")
      << "the moving hand is stored too";
  const fs::path direct = store(dir_ / "direct", r, Finish::Hdf5), device = store(dir_ / "device", r, Finish::Cbor);
  EXPECT_EQ(direct.extension(), ".h5");
  EXPECT_EQ(device.extension(), ".cbor");
  EXPECT_FALSE(fs::exists(dir_ / "device" / direct.filename())) << "the device wrote no HDF5";
  const auto imported = import_runs(dir_ / "device");
  ASSERT_EQ(imported.size(), 1u);
  ASSERT_FALSE(bytes(direct).empty());
  EXPECT_EQ(bytes(imported[0]), bytes(direct));
  EXPECT_EQ(bytes(fs::path(imported[0]).replace_extension(".xdmf")),
            bytes(fs::path(direct).replace_extension(".xdmf")));
  // Nothing is lost on the way through CBOR either: straight from memory comes the same file.
  write_hdf5(dir_ / "memory" / "x.h5", r);
  EXPECT_EQ(bytes(dir_ / "memory" / "x.h5"), bytes(direct));
}

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const SolverEntry& e : solvers())
    for (const char* scene : {"paper/gravity", "paper/capsule-sweep"}) all.push_back({e.info.name, scene});
  return all;
}

TEST(ImportArguments, AnUnfinishedRunIsRefused) {
  const fs::path dir = fs::temp_directory_path() / ("clothbench-import-part-" + std::to_string(getpid()));
  RunHeader h;
  h.scene = "s";
  h.solver = "none";
  h.setting = "default";
  h.settings = h.plan = h.environment = nlohmann::json::object();
  RunWriter writer(dir, h, Finish::Cbor);
  EXPECT_TRUE(import_runs(dir).empty());
  const std::string part = (dir / "s__none__default.part").string();
  try {
    import_runs(part);
    ADD_FAILURE() << "a part file named by itself is passed over in silence";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
  }
  EXPECT_EQ(import_runs(writer.finish({}, {})), std::vector<fs::path>{dir / "s__none__default.h5"});
  EXPECT_TRUE(fs::exists(dir / "s__none__default.h5"));
  fs::remove_all(dir);
}

INSTANTIATE_TEST_SUITE_P(Every, Import, ::testing::ValuesIn(cases()),
                         [](const auto& one) { return name_of(one.param); });

}  // namespace
}  // namespace clothbench
