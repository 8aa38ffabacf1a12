#include "scenario/collider_reader.hpp"

#include <cmath>

#include "base/json_text.hpp"
#include "clothbench/error.hpp"
#include "clothbench/vector.hpp"
#include "scenario/scene_parts.hpp"
#include "scenario/vec3.hpp"

namespace clothbench {

void ColliderReader::enter(std::string at) {
  at_ = std::move(at);
  pose = nullptr;
  table.reset();
}

void ColliderReader::complete(nlohmann::json& j, const std::string& definition) const {
  const nlohmann::json schema = nlohmann::json::parse(kSceneSchema);
  nlohmann::json sub = schema["definitions"][definition];
  sub["definitions"] = schema["definitions"];
  validate_json(j, sub.dump(), source_, at_);
  fill_defaults(j, sub.dump());
}

void ColliderReader::refuse(const std::string& key, const std::string& expected) const {
  throw Error(source_ + ": " + at_ + key + ": " + expected);
}

Vec3 ColliderReader::unit(const nlohmann::json& j, const std::string& key) const {
  constexpr double kUnit = 1e-9;  // tolerance of the squared length
  const Vec3 v = vec3(j[key]);
  if (!(std::abs(dot(v, v) - 1) <= kUnit)) refuse("/" + key, "expected a vector of length 1");
  return v;
}

Path ColliderReader::path(const nlohmann::json& j) const {
  Path p = Path::read(j);
  note_jumps(p, scene_);
  return p;
}

const assets::AssetSource& ColliderReader::assets() {
  if (!assets_) {
    assets_ = assets::locate_assets(wanted_ == Assets::Required);
    scene_.assets = assets_->kind();
  }
  return *assets_;
}

}  // namespace clothbench
