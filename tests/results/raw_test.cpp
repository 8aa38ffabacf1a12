#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <random>

#include "base/json_number.hpp"
#include "clothbench/error.hpp"
#include "results/raw_file.hpp"
#include "results/store.hpp"
#include "sample_run.hpp"
#include "with_folder.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

class Raw : public WithFolder {
 protected:
  void TearDown() override {
    fs::permissions(dir_, fs::perms::owner_all);
    WithFolder::TearDown();
  }
  static std::string bytes(const fs::path& p) {
    std::ifstream in(p, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  static void write(const fs::path& p, const std::string& s) { std::ofstream(p, std::ios::binary) << s; }
};

TEST_F(Raw, Crc32cAgreesWithThePublishedVector) {
  const std::string digits = "123456789";  // RFC 3720, B.4 and common practice
  EXPECT_EQ(crc32c(reinterpret_cast<const std::uint8_t*>(digits.data()), digits.size()), 0xe3069283u);
}

TEST_F(Raw, TrialsAndAccuracyRoundTripBitForBit) {
  const RunRecord r = sample_run();
  write_trial_file(dir_ / "t.raw", r.trials[1], 2);
  EXPECT_TRUE(same(read_trial_file(dir_ / "t.raw"), r.trials[1]));
  write_accuracy_file(dir_ / "a.raw", r.accuracy, r.header.vertices);
  const AccuracyPass a = read_accuracy_file(dir_ / "a.raw");
  EXPECT_EQ(a.position, r.accuracy.position);
  EXPECT_EQ(a.time_s, r.accuracy.time_s);
  ASSERT_EQ(a.metrics.size(), 2u);
  EXPECT_TRUE(same(a.metrics[0].values, r.accuracy.metrics[0].values));
  write_replay_file(dir_ / "r.raw", r.replay);
  const std::vector<StoredGroup> replay = read_replay_file(dir_ / "r.raw");
  ASSERT_EQ(replay.size(), 3u);
  EXPECT_EQ(replay[1].attributes, r.replay[1].attributes);
  ASSERT_EQ(replay[1].arrays.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(replay[1].arrays[k].values, r.replay[1].arrays[k].values);
    EXPECT_EQ(replay[1].arrays[k].dims, r.replay[1].arrays[k].dims);
    EXPECT_EQ(replay[1].arrays[k].shape, r.replay[1].arrays[k].shape);
    EXPECT_EQ(replay[1].arrays[k].integer, k == 1);
  }
  EXPECT_EQ(header_to_json(header_from_json(header_to_json(r.header))), header_to_json(r.header));
}

TEST_F(Raw, EveryFlippedByteIsFound) {
  const fs::path file = dir_ / "t.raw";
  write_trial_file(file, sample_run().trials[0], 2);
  const std::string good = bytes(file);
  for (std::size_t k = 0; k < good.size(); ++k) {
    std::string bad = good;
    bad[k] = static_cast<char>(bad[k] ^ 0x10);
    write(file, bad);
    EXPECT_THROW(read_trial_file(file), Error) << "byte " << k;
  }
}

TEST_F(Raw, EveryTornTailIsCut) {
  const fs::path file = dir_ / "t.raw";
  write_trial_file(file, sample_run().trials[0], 2);
  const std::string good = bytes(file);
  const std::size_t frame_B = read_raw(file).header["frame_B"], header_B = good.size() - 4 * frame_B;
  for (std::size_t k = 0; k < good.size(); ++k) {
    write(file, good.substr(0, k));
    if (k < header_B) {
      EXPECT_THROW(read_raw(file), Error) << k;
      continue;
    }
    const RawFile torn = read_raw(file);
    EXPECT_EQ(torn.frames.size(), (k - header_B) / frame_B) << k;
    EXPECT_EQ(torn.complete, (k - header_B) % frame_B == 0) << k;
    EXPECT_THROW(read_trial_file(file), Error) << "a trial is whole or not there";
  }
}

TEST_F(Raw, NoiseNeverCrashesAReader) {
  std::mt19937 random(1);
  const RunRecord r = sample_run();
  write_trial_file(dir_ / "t.raw", r.trials[0], 2);
  write_accuracy_file(dir_ / "a.raw", r.accuracy, r.header.vertices);
  const std::string good[] = {bytes(dir_ / "t.raw"), bytes(dir_ / "a.raw")};
  for (int k = 0; k < 2000; ++k) {
    std::string bad = good[k % 2];
    for (int n = 0; n < 1 + k % 8; ++n) bad[random() % bad.size()] = static_cast<char>(random());
    if (k % 3 == 0) bad.resize(random() % bad.size());
    write(dir_ / "x.raw", bad);
    try {
      read_trial_file(dir_ / "x.raw");
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find("x.raw"), std::string::npos) << e.what();
    }
    try {
      read_accuracy_file(dir_ / "x.raw");
    } catch (const Error&) {
    }
  }
}

TEST_F(Raw, InfinityIsNotMissing) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  RunRecord r = sample_run();
  r.summary = {{"a", kInfinity}, {"b", -kInfinity}, {"c", kMissing}, {"d", 0.1}};
  for (const Finish how : {Finish::Raw, best_finish()}) {
    RunWriter writer(dir_, r.header, how);
    const std::map<std::string, double> read = read_run(writer.finish(r.outcome, r.summary)).summary;
    EXPECT_EQ(read.at("a"), kInfinity);
    EXPECT_EQ(read.at("b"), -kInfinity);
    EXPECT_TRUE(std::isnan(read.at("c")));
    EXPECT_EQ(read.at("d"), 0.1);
  }
}

TEST_F(Raw, NumbersInJsonReadBackAndOldNullsAreMissing) {
  for (const double v :
       {1.0 / 3, -0.0, std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()})
    EXPECT_EQ(number_from_json(nlohmann::json::parse(number_to_json(v).dump()), "v"), v);
  EXPECT_TRUE(number_to_json(kMissing).is_null());
  EXPECT_TRUE(std::isnan(number_from_json(nlohmann::json(), "v"))) << "as older versions wrote what is missing";
  try {
    number_from_json("infinite", "stability_depth_max");
    ADD_FAILURE() << "any text passes for a number";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("stability_depth_max"), std::string::npos) << e.what();
  }
}

TEST_F(Raw, AnotherRunsTrialsAreNotMixedIn) {
  RunRecord r = sample_run();
  RunWriter first(dir_, r.header);
  first.write_trial(r.trials[0]);
  r.header.scenario_sha256 = "11ff";
  EXPECT_THROW(RunWriter(dir_, r.header), Error);
}

TEST_F(Raw, AFolderThatTakesNothingIsAnErrorAndKeepsWhatIsThere) {
  const fs::path full = dir_ / "full";
  fs::create_directories(full);
  const RunRecord r = sample_run();
  RunWriter writer(full, r.header);
  writer.write_trial(r.trials[0]);
  const fs::path part = full / (run_name(r.header) + ".part");
  if (geteuid() == 0) {
    // Root may write anywhere; but a folder in place of the temporary file cannot be opened for writing.
    fs::create_directories(part / ("trial-1.raw.tmp." + std::to_string(getpid())));
  } else {
    fs::permissions(part, fs::perms::owner_read | fs::perms::owner_exec);
  }
  try {
    writer.write_trial(r.trials[1]);
    ADD_FAILURE() << "wrote into a folder that takes nothing";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("trial-1.raw"), std::string::npos) << e.what();
  }
  fs::permissions(part, fs::perms::owner_all);
  const RunRecord kept = writer.recovered();
  ASSERT_EQ(kept.trials.size(), 1u);
  EXPECT_TRUE(same(kept.trials[0], r.trials[0]));
}

}  // namespace
}  // namespace clothbench
