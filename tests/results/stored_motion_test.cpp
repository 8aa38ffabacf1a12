// Scene and motion are read from a result file only, without the scenario's folder, its meshes, rooms and hands.
#include <gtest/gtest.h>

#include <fstream>

#include "assets/assets.hpp"
#include "base/files.hpp"
#include "refusal.hpp"
#include "results/store.hpp"
#include "scenario/load.hpp"
#include "with_folder.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

/// During its lifetime, neither scenarios nor assets can be found.
struct WithoutData {
  Variable scenarios{kScenarioFolder.variable, "/nonexistent"}, assets{"CLOTHBENCH_ASSETS", "/nonexistent"};
};

RunHeader header_of(const Scene& scene) {
  RunHeader h;
  h.scene = scene.name;
  h.solver = "none";
  h.setting = "default";
  h.settings = h.plan = h.environment = nlohmann::json::object();
  h.scenario_json = scene.json;
  h.scenario_sha256 = scene.sha256;
  h.vertices = static_cast<std::uint32_t>(scene.cloth.vertex_count());
  for (const auto& t : triangles(scene.cloth)) h.triangles.insert(h.triangles.end(), t.begin(), t.end());
  return h;
}

/// `frames` frames at the initial position.
AccuracyPass at_start(const Scene& scene, int frames) {
  AccuracyPass pass;
  const std::vector<double> x = initial_positions(scene);
  for (int f = 0; f < frames; ++f) {
    pass.time_s.push_back(scene.time.at(f));
    for (const double v : x) pass.position.push_back(static_cast<float>(v));
  }
  return pass;
}

fs::path stored(const fs::path& dir, const Scene& scene, const RunHeader& header, Finish how = best_finish()) {
  RunWriter writer(dir, header, how);
  writer.write_replay(replay_of(scene));
  writer.write_accuracy(at_start(scene, 3));
  return writer.finish({}, {});
}

StoredMotion read_alone(const fs::path& file) {
  const WithoutData none;
  return read_motion(file);
}

/// Compares colliders, grips, their motion and jumps: their stored form, and the other data that solvers read.
void expect_same_stage(const Scene& a, const Scene& b) {
  ASSERT_EQ(a.colliders.size(), b.colliders.size());
  for (std::size_t k = 0; k < a.colliders.size(); ++k) {
    const Collider &p = a.colliders[k], &q = b.colliders[k];
    EXPECT_EQ(p.feature(), q.feature());
    EXPECT_EQ(p.capsules.size(), q.capsules.size());
    EXPECT_EQ(p.half_extent_m, q.half_extent_m);
    EXPECT_EQ(p.axes, q.axes);
    EXPECT_EQ(p.radius_m, q.radius_m);
    EXPECT_EQ(p.normal, q.normal);
    EXPECT_EQ(p.center_m, q.center_m);
  }
  const std::vector<StoredGroup> one = replay_of(a), two = replay_of(b);
  ASSERT_EQ(one.size(), two.size());
  for (std::size_t g = 0; g < one.size(); ++g) {
    EXPECT_EQ(one[g].path, two[g].path);
    EXPECT_EQ(one[g].attributes, two[g].attributes) << one[g].path;
    ASSERT_EQ(one[g].arrays.size(), two[g].arrays.size()) << one[g].path;
    for (std::size_t k = 0; k < one[g].arrays.size(); ++k) {
      EXPECT_EQ(one[g].arrays[k].name, two[g].arrays[k].name);
      EXPECT_EQ(one[g].arrays[k].shape, two[g].arrays[k].shape) << one[g].arrays[k].name;
      EXPECT_EQ(one[g].arrays[k].values, two[g].arrays[k].values) << one[g].arrays[k].name;
    }
  }
}

void expect_same_cloth(const Scene& a, const Scene& b) {
  // A generated sheet is centred after its edges are measured, which rounds their lengths.
  const auto near = [](const std::vector<double>& p, const std::vector<double>& q) {
    ASSERT_EQ(p.size(), q.size());
    for (std::size_t k = 0; k < p.size(); ++k) ASSERT_NEAR(p[k], q[k], 1e-14 + 1e-12 * std::abs(p[k])) << k;
  };
  near(vertex_masses(a), vertex_masses(b));
  EXPECT_EQ(initial_positions(a), initial_positions(b));
  EXPECT_EQ(initial_velocities(a), initial_velocities(b));
  EXPECT_EQ(a.pins.vertices, b.pins.vertices);
  EXPECT_EQ(triangles(a.cloth), triangles(b.cloth));
  for (const EdgeKind kind : {EdgeKind::Structural, EdgeKind::Shear, EdgeKind::SkipOne}) {
    std::vector<double> p, q;
    for (const Edge& e : edges(a.cloth, kind)) p.push_back(e.rest_m);
    for (const Edge& e : edges(b.cloth, kind)) q.push_back(e.rest_m);
    near(p, q);
  }
  EXPECT_EQ(edge_stiffnesses(a), edge_stiffnesses(b));
  ASSERT_EQ(a.cloth.mesh == nullptr, b.cloth.mesh == nullptr);
  if (a.cloth.mesh) {
    EXPECT_EQ(a.cloth.mesh->groups, b.cloth.mesh->groups);
  }
}

class StoredMotionOf : public WithFolder, public ::testing::WithParamInterface<std::string> {};

TEST_P(StoredMotionOf, ItsSceneIsTheOneThatRan) {
  const Scene scene = load_scene(GetParam());
  const StoredMotion m = read_alone(stored(dir_, scene, header_of(scene)));
  const AccuracyPass pass = at_start(scene, 3);
  EXPECT_EQ(m.time_s, pass.time_s);
  EXPECT_EQ(m.position, pass.position);
  EXPECT_TRUE(m.contact_margins_m.empty());
  expect_same_cloth(scene, m.scene);
  expect_same_stage(scene, m.scene);
  EXPECT_EQ(m.scene.sha256, scene.sha256);
  EXPECT_EQ(m.scene.json, scene.json);
  EXPECT_TRUE(m.scene.needs == scene.needs);
  EXPECT_EQ(m.scene.time.ends_s, scene.time.ends_s);
  EXPECT_EQ(m.scene.assets, scene.assets);
  EXPECT_EQ(m.scene.reference_case, scene.reference_case);
  ASSERT_EQ(m.scene.expect.size(), scene.expect.size());
  for (std::size_t k = 0; k < scene.expect.size(); ++k) EXPECT_EQ(m.scene.expect[k].name, scene.expect[k].name);
}

INSTANTIATE_TEST_SUITE_P(Every, StoredMotionOf,
                         ::testing::ValuesIn(scene_names({"paper", "contact", "garments", "validation", "stability",
                                                          "conformance"})),
                         [](const auto& scene) { return test_name(scene.param); });

class StoredMotionFile : public WithFolder {
 protected:
  Scene scene_ = load_scene("contact/sphere", {"cloth.grid=[5,4]"});
};

TEST_F(StoredMotionFile, AMeshIsReadAfterItsFileIsGone) {
  fs::copy(fs::path(CLOTHBENCH_SOURCE_DIR) / "scenarios/assets/sleeve-small.obj", dir_ / "a.obj");
  nlohmann::json j = nlohmann::json::parse(load_scene("garments/sleeve").json);
  j["cloth"]["mesh"] = {{"file", "a.obj"}};
  j.erase("assets");
  const std::string group = load_scene("garments/sleeve").cloth.mesh->groups.begin()->first;
  j["cloth"]["mass_factors"] = {{{"group", group}, {"factor", 3}}};
  std::ofstream(dir_ / "s.json") << j.dump();
  const Scene scene = load_scene((dir_ / "s.json").string());
  const fs::path file = stored(dir_, scene, header_of(scene));
  fs::remove(dir_ / "a.obj");
  expect_same_cloth(scene, read_alone(file).scene);
}

TEST_F(StoredMotionFile, ACborFileHoldsTheSame) {
  const StoredMotion m = read_alone(stored(dir_, scene_, header_of(scene_), Finish::Cbor));
  expect_same_cloth(scene_, m.scene);
  expect_same_stage(scene_, m.scene);
  EXPECT_EQ(m.position, at_start(scene_, 3).position);
}

TEST_F(StoredMotionFile, StatesTheContactMargins) {
  RunHeader h = header_of(scene_);
  h.plan = {{"contact_margins", {{{"collider", scene_.colliders[0].name}, {"margin_m", 0.0125}}}}};
  EXPECT_EQ(read_alone(stored(dir_, scene_, h)).contact_margins_m, std::vector<double>{0.0125});
}

TEST_F(StoredMotionFile, WhatDoesNotFitIsNamed) {
  const auto fault = [](const fs::path& file) {
    const std::string why = refusal([&] { read_alone(file); });
    EXPECT_PRED2(mentions, why, file.string());
    return why;
  };
  RunHeader h = header_of(scene_);
  const nlohmann::json one = {{"collider", "sphere"}, {"margin_m", 0.0125}};
  h.plan = {{"contact_margins", {one, one}}};
  EXPECT_PRED2(mentions, fault(stored(dir_, scene_, h)), "/plan/contact_margins");
  const Scene mesh = load_scene("validation/hang-mesh");
  RunWriter writer(dir_, header_of(mesh));
  writer.write_accuracy(at_start(mesh, 2));
  EXPECT_PRED2(mentions, fault(writer.finish({}, {})), "/cloth, the cloth's mesh, is missing");
}

TEST_F(StoredMotionFile, ARunWithoutTrajectoryHasNone) {
  const fs::path file = RunWriter(dir_, header_of(scene_)).finish({"unsupported", "ok", -1, "no sphere"}, {});
  EXPECT_TRUE(read_alone(file).time_s.empty());
}

}  // namespace
}  // namespace clothbench
