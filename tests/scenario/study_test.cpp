#include "scenario/study.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "clothbench/error.hpp"
#include "clothbench/solver.hpp"

namespace clothbench {
namespace {

TEST(Study, Table3IsFiveResolutionsByThreeSides) {
  const Study s = load_study("table3");
  EXPECT_EQ(s.scenes.size(), 15u);
  EXPECT_EQ(s.trials, 5);
  EXPECT_EQ(s.scenes.front().scene.name, "gravity-8-single");
  EXPECT_EQ(s.scenes.back().scene.name, "gravity-128-double");
  EXPECT_EQ(s.scenes.back().scene.cloth.columns, 128);
  EXPECT_EQ(s.scenes.back().group, 4) << "cells of one resolution are one interleaved group";
}

TEST(Study, FaultsNameFileAndPointer) {
  const auto fault = [](const std::string& from, const std::string& to) -> std::string {
    std::ifstream in(CLOTHBENCH_SOURCE_DIR "/scenarios/studies/table3.json");
    std::string text((std::istreambuf_iterator<char>(in)), {});
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    const auto gravity = text.find("../paper/gravity.json");
    if (gravity != std::string::npos) text.replace(gravity, 21, CLOTHBENCH_SOURCE_DIR "/scenarios/paper/gravity.json");
    const auto file = std::filesystem::temp_directory_path() / "clothbench-study-test.json";
    std::ofstream(file) << text;
    try {
      load_study(file.string());
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(fault("\"trials\": 5", "\"trials\": 6"), "");
  EXPECT_NE(fault("\"trials\": 5", "\"trials\": 0").find("/trials"), std::string::npos);
  EXPECT_NE(fault("\"drop_frames\"", "\"dropframes\"").find("nearest known: drop_frames"), std::string::npos);
  EXPECT_NE(fault("\"labels\": [\"8\", ", "\"labels\": [").find("/scenes/0/axes/0/labels"), std::string::npos);
  EXPECT_NE(fault("[8, 8]", "[0, 8]").find("/cloth/grid/0"), std::string::npos);
  EXPECT_NE(fault("../paper/gravity.json", "nowhere.json").find("nowhere.json"), std::string::npos);
}

TEST(Settings, AreCompletedAndChecked) {
  SolverInfo info;
  info.name = "s";
  info.settings = {{"iterations", "5", ""}, {"stiffness", "0.8", ""}, {"mode", "\"a\"", ""}};
  EXPECT_EQ(complete_settings(info, {{"iterations", 7}})["iterations"], 7);
  EXPECT_EQ(complete_settings(info, {{"stiffness", 1}})["stiffness"], 1) << "an integer is a number";
  const auto fault = [&](const nlohmann::json& given) -> std::string {
    try {
      complete_settings(info, given);
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_NE(fault({{"iteration", 7}}).find("nearest known: iterations"), std::string::npos);
  EXPECT_NE(fault({{"iterations", 7.5}}).find("expected an integer"), std::string::npos);
  EXPECT_NE(fault({{"mode", true}}).find("expected a string"), std::string::npos);
}

TEST(Solvers, NearestNameIsNamed) {
  try {
    find_solver("balistic");
    ADD_FAILURE();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("nearest known: ballistic"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace clothbench
