#include "clothbench/error.hpp"
#include "sheets.hpp"

namespace clothbench {
namespace {

Collider floor_below(double height_m) {
  Collider c;
  c.shape = Collider::Shape::Plane;
  c.name = "floor";
  c.center_m = {0, height_m, 0};
  c.normal = {0, 1, 0};
  return c;
}

TEST_P(Bullet, SaysWhatItCannotDo) {
  const SolverInfo& info = entry_of(GetParam()).info;
  for (Feature f : {Feature::DuplicatedLayer, Feature::SelfCollision})
    EXPECT_EQ(unsupported(info, {Feature::Stretch, f}), FeatureSet{f});
  EXPECT_TRUE(
      unsupported(info, kColliderFeatures | FeatureSet{Feature::Friction, Feature::DoubleSided, Feature::MovingPins})
          .empty());
}

TEST_P(Bullet, SaysWhatMarginItKeepsInsteadOfTheScenes) {
  const Scene s = with_collider(sheet(5, 4), floor_below(-0.5));
  const auto margin_lines = [&](const nlohmann::json& settings) {
    const auto solver = make_solver(GetParam(), settings);
    solver->load(s);
    std::vector<LeftOut> found;
    for (const LeftOut& l : solver->plan().left_out)
      if (l.what.find("margin of 0.004 m") != std::string::npos) found.push_back(l);
    return found;
  };
  const auto by_default = margin_lines(nlohmann::json::object());
  ASSERT_EQ(by_default.size(), 1U);
  EXPECT_NE(by_default[0].what.find("floor"), std::string::npos);
  EXPECT_NE(by_default[0].why.find("collision_margin_m = 0.02 m"), std::string::npos);
  EXPECT_TRUE(margin_lines({{"collision_margin_m", 0.0}}).empty()) << "0 takes the scene's";
}

TEST_P(Bullet, TellsTheMarginThatMetricsGoBy) {
  Scene s = with_collider(sheet(5, 4), floor_below(-0.5));
  s.colliders.push_back(s.colliders[0]);
  s.colliders[1].margin_m = 0.01;
  const auto margins = [&](const nlohmann::json& settings) {
    const auto solver = make_solver(GetParam(), settings);
    solver->load(s);
    return solver->plan().contact_margins_m;
  };
  EXPECT_EQ(margins(nlohmann::json::object()), (std::vector<double>{0.02, 0.02}));
  EXPECT_EQ(margins({{"collision_margin_m", 0.003}}), (std::vector<double>{0.003, 0.003}));
  EXPECT_EQ(margins({{"collision_margin_m", 0.0}}), (std::vector<double>{0.01, 0.01})) << "one for all: the widest";
}

TEST_P(Bullet, RefusesSettingsByName) {
  const auto message = [&](const char* key, const nlohmann::json& value) {
    try {
      make_solver(GetParam(), {{key, value}});
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  for (const auto& [key, value] :
       std::map<const char*, nlohmann::json>{{"substeps", -1}, {"collision_margin_m", -0.1}, {"sdf_voxel_m", 0.0}}) {
    EXPECT_NE(message(key, value).find(GetParam() + ": setting " + key), std::string::npos)
        << key << ": " << message(key, value);
    EXPECT_NE(message(key, value).find(value.dump()), std::string::npos) << key;
  }
}

TEST_P(Bullet, RefusesACapsuleThatGrows) {
  Collider c;
  c.shape = Collider::Shape::Capsules;
  c.name = "finger";
  c.capsules = {{{0, -1, 0}, {0.1, -1, 0}, 0.01}};
  Scene s = with_collider(sheet(5, 4), c);
  for (double tip : {0.1, 0.11}) {
    FrameMotion m;
    m.colliders.resize(1);
    m.colliders[0].capsules = {{{0, -1, 0}, {tip, -1, 0}, 0.01}};
    s.motion.push_back(m);
  }
  const auto solver = make_solver(GetParam());
  try {
    solver->load(s);
    FAIL() << "loaded";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("collider finger: capsule 0"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace clothbench
