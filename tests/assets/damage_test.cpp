#include <filesystem>
#include <limits>

#include "assets/hand.hpp"
#include "assets/room.hpp"
#include "base/files.hpp"
#include "support.hpp"

namespace clothbench::assets {
namespace {

namespace fs = std::filesystem;

std::string room_text() {
  std::vector<float> vertices;
  for (double x : tetrahedron().positions) vertices.push_back(static_cast<float>(x));
  std::vector<std::uint32_t> indices;
  for (const auto& t : tetrahedron().triangles) indices.insert(indices.end(), t.begin(), t.end());
  return R"({"type": "scene", "version": 1, "spatialEntities": [
 {"uuid": "t-1", "semanticLabel_META": "TABLE", "locatable_META": {"orientation": {"x": -0.5, "y": 0.5, "z": 0.5, "w": 0.5}},
  "bounded3D_META": {"offset": {"z": -0.75}, "extent": {"width": 1, "height": 2, "depth": 0.75}}},
 {"uuid": "m-1", "semanticLabel_META": "UNRECOGNIZED", "locatable_META": {"position": {"y": 2}, "orientation": {"w": 1}},
  "triangleMesh_META": {"vertices": ")" +
         base64_of(vertices) + R"(", "indices": ")" + base64_of(indices) + "\"}}]}";
}

TEST(RoomText, LeftOutFieldsAreZero) {
  const Room room = parse_room(room_text(), "r.json", "r");
  EXPECT_EQ(room.mesh.vertex(0), Vector(0, 2, 0));
  ASSERT_EQ(room.tables.size(), 1u);
  EXPECT_EQ(room.tables[0].box.min(), Vector(0, 0, -0.75));
}

TEST(RoomText, DamageIsNamedWithItsPlace) {
  const std::string vertices = "\"vertices\": \"", indices = "\"indices\": \"", entity = "/spatialEntities/1",
                    mesh = "/triangleMesh_META/";
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinite = std::numeric_limits<float>::infinity();
  const auto floats = base64_of<float>;
  const auto corners = base64_of<std::uint32_t>;
  const struct {
    std::string from, to, where;
    const char* says;
  } bad[] = {
      {"\"scene\"", "\"anchor\"", "/type", "scene"},
      {"\"version\": 1", "\"version\": 2", "/version", "one of [1]"},
      {"\"version\": 1, ", "", "/", "\"version\" is missing"},
      {"triangleMesh_META", "triangleMesh", "/spatialEntities", "expected an entity with triangleMesh_META"},
      {vertices, vertices + "AA", entity + mesh + "vertices", "multiple of 4"},
      {vertices, vertices + "AA*A", entity + mesh + "vertices", "alphabet"},
      {vertices, vertices + floats({1, 2, 3}).substr(0, 4), mesh + "vertices", "multiple of 12"},
      {vertices, vertices + floats({0, nan, 0}), mesh + "vertices", "vertex 0 is not finite"},
      {vertices, vertices + floats({0, 0, infinite}), mesh + "vertices", "not finite"},
      {vertices, "\"vertices\": 3, \"v\": \"", mesh + "vertices", "expected string"},
      {indices, indices + corners({0, 1, 4}), mesh + "indices", "names vertex 4, but there are 4"},
      {indices, indices + corners({0xffffffffu, 1, 2}), mesh + "indices", "4294967295"},
      {indices, "\"index\": \"", entity + "/triangleMesh_META", "\"indices\" is missing"},
      {"\"locatable_META\": {\"position\"", "\"located\": {\"position\"", entity, "locatable_META"},
      {"\"w\": 1", "\"w\": 3", entity + "/locatable_META/orientation", "unit quaternion"},
      {"\"depth\": 0.75", "\"depth\": -0.75", "/spatialEntities/0/bounded3D_META/extent/depth", "> 0"},
      {"\"z\": -0.75", "\"z\": \"NaN\"", "/spatialEntities/0/bounded3D_META/offset/z", "expected number"},
      {"{\"type\"", "{type", "line 1", "not valid JSON"},
      {"\"spatialEntities\": [", "\"spatialEntities\": {}, \"x\": [", "/spatialEntities", "expected array"},
  };
  for (const auto& b : bad) {
    const std::string text = replaced(room_text(), b.from, b.to);
    const std::string message = error_of([&] { parse_room(text, "my-room.json", "r"); });
    EXPECT_EQ(message.find("my-room.json: "), 0u) << message;
    EXPECT_PRED2(mentions, message, b.where);
    EXPECT_PRED2(mentions, message, b.says);
  }
}

TEST(RoomText, MissingFileAndFolder) {
  EXPECT_PRED2(mentions, error_of([] { load_room("/nonexistent/room.json"); }), "/nonexistent/room.json: no such file");
  EXPECT_PRED2(mentions, error_of([] { load_room(CLOTHBENCH_SOURCE_DIR); }), "folder");
}

struct Edit {
  std::string from, to, says;
};

fs::path right_hand(const AssetSource& source) {
  return source.root / "@webxr-input-profiles/assets/dist/profiles/generic-hand/right.glb";
}

TEST(Glb, WrongJsonIsAnError) {
  NEED_NPM_ASSETS(source);
  const std::string text = content_of(right_hand(source));
  for (const Edit& e : {Edit{"\"ring-finger-tip\"", "\"ring-finger-top\"", "not a WebXR hand joint"},
                        Edit{"\"count\":1360", "\"count\":9999", "no more than its buffer view holds"},
                        Edit{"\"WEIGHTS_0\"", "\"WEIGHTS_9\"", "\"WEIGHTS_0\" is missing"},
                        Edit{"\"bufferView\":4", "\"bufferView\":9", "edited.glb: "},
                        Edit{"\"inverseBindMatrices\":6", "\"inverseBindMatrices\":0", "/accessors/0"}}) {
    ASSERT_EQ(e.to.size(), e.from.size()) << "the chunk's length is in the header";
    const std::string edited = replaced(text, e.from, e.to);
    const std::string message = error_of([&] { parse_hand_glb(edited, "edited.glb"); });
    EXPECT_PRED2(mentions, message, e.says);
  }
}

TEST(PoseModule, Damage) {
  NEED_NPM_ASSETS(source);
  const std::string text = content_of(source.root / "iwer/lib/device/configs/hand/relaxed.js");
  for (const Edit& e :
       {Edit{"'thumb-tip'", "'thumb-top'", "/jointTransforms: \"thumb-tip\" is missing"},
        Edit{"radius:", "radios:", "/jointTransforms/wrist: \"radius\" is missing"},
        Edit{"radius: 0", "radius: -0", "/jointTransforms/wrist/radius"},
        Edit{"offsetMatrix: [", "offsetMatrix: [1, ", "/jointTransforms/wrist/offsetMatrix: expected array, 16 items"},
        Edit{"0.9616971015930176", "0.5", "/jointTransforms/wrist/offsetMatrix: expected a rotation"},
        Edit{"offsetMatrix: [", "offsetMatrix: [Math.PI * ", "not valid JSON"},
        Edit{"offsetMatrix: [", "offsetMatrix: [NaN, ", "not valid JSON"},
        Edit{"'thumb-tip'", "'thumb-tip", "not valid JSON"}, Edit{"=", "", "expected a module"}}) {
    const std::string edited = replaced(text, e.from, e.to);
    const std::string message = error_of([&] { parse_pose_js(edited, "pose.js"); });
    EXPECT_EQ(message.find("pose.js"), 0u) << message;
    EXPECT_PRED2(mentions, message, e.says);
  }
}

}  // namespace
}  // namespace clothbench::assets
