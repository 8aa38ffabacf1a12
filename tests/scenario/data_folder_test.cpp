#include "base/data_folder.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "refusal.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

constexpr DataFolder kFolder{"test files", "CLOTHBENCH_DATA_FOLDER_TEST", "installed/here", "built/there"};

class DataFolderTest : public testing::Test {
 protected:
  void SetUp() override {
    home_ = fs::path(testing::TempDir()) /
            ("data-folder-" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(home_);
    roots_ = {home_ / "share", home_ / "source"};
    unsetenv(kFolder.variable);
  }
  void TearDown() override {
    unsetenv(kFolder.variable);
    fs::remove_all(home_);
  }

  std::string why() const {
    return refusal([&] { find_data(kFolder, roots_); });
  }

  fs::path home_;
  DataRoots roots_;
};

TEST_F(DataFolderTest, VariableThenInstalledThenSource) {
  const fs::path source = roots_.source / "built/there", installed = roots_.installed / "installed/here",
                 named = home_ / "named";
  fs::create_directories(source);
  EXPECT_EQ(find_data(kFolder, roots_), source);
  fs::create_directories(installed);
  EXPECT_EQ(find_data(kFolder, roots_), installed);
  fs::create_directories(named);
  setenv(kFolder.variable, named.c_str(), 1);
  EXPECT_EQ(find_data(kFolder, roots_), named);
  setenv(kFolder.variable, "", 1);  // as good as not set
  EXPECT_EQ(find_data(kFolder, roots_), installed);
}

TEST_F(DataFolderTest, OneErrorNamesEveryPlace) {
  const fs::path installed = roots_.installed / "installed/here", source = roots_.source / "built/there",
                 named = home_ / "nowhere";
  fs::create_directories(source.parent_path());
  std::ofstream(source) << "a file is no folder";
  for (const std::string& place :
       {std::string("CLOTHBENCH_DATA_FOLDER_TEST"), installed.string(), source.string(), std::string("test files")})
    EXPECT_PRED2(mentions, why(), place);
  fs::create_directories(installed);
  setenv(kFolder.variable, named.c_str(), 1);  // a wrong variable is not passed over
  for (const fs::path& place : {named, installed, source}) EXPECT_PRED2(mentions, why(), place.string());
}

TEST_F(DataFolderTest, AProgramOfUnknownPlaceStillHasItsSourceTree) {
  roots_.installed.clear();
  EXPECT_EQ(usual_places(kFolder, roots_), std::vector<fs::path>{roots_.source / "built/there"});
}

TEST(DataRoots, ShareIsBesideTheProgramsFolder) {
  const fs::path program = fs::read_symlink("/proc/self/exe");
  EXPECT_EQ(data_roots().installed, program.parent_path().parent_path() / "share/clothbench");
  EXPECT_EQ(data_roots().source, CLOTHBENCH_SOURCE_DIR);
}

TEST(DataRoots, ASceneByItsPathNeedsNoScenarioFolder) {
  const char* before = std::getenv("CLOTHBENCH_SCENARIOS");
  const std::string kept = before == nullptr ? "" : before;
  const std::string scene = CLOTHBENCH_SOURCE_DIR "/scenarios/validation/hang-mesh.json";
  ASSERT_EQ(load_scene(scene).name, "hang-mesh");
  const fs::path own = fs::path(testing::TempDir()) / "data-folder-own-scene";
  fs::create_directories(own / "assets");
  fs::copy(CLOTHBENCH_SOURCE_DIR "/scenarios/assets", own / "assets",
           fs::copy_options::recursive | fs::copy_options::overwrite_existing);
  fs::copy_file(scene, own / "hang-mesh.json", fs::copy_options::overwrite_existing);
  setenv("CLOTHBENCH_SCENARIOS", "/nonexistent", 1);
  EXPECT_EQ(load_scene((own / "hang-mesh.json").string()).name, "hang-mesh");
  EXPECT_THROW(load_scene("paper/gravity"), Error);
  before == nullptr ? unsetenv("CLOTHBENCH_SCENARIOS") : setenv("CLOTHBENCH_SCENARIOS", kept.c_str(), 1);
  fs::remove_all(own);
}

}  // namespace
}  // namespace clothbench
