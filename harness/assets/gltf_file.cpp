#include "assets/gltf_file.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

// The header again, for the definitions; a file that is compiled together with this one must not get them twice.
#define TINYGLTF_IMPLEMENTATION
#include <tiny_gltf.h>
#undef TINYGLTF_IMPLEMENTATION

#include "assets/mesh.hpp"
#include "base/json_text.hpp"
#include "base/words.hpp"
#include "clothbench/error.hpp"

namespace clothbench::assets::gltf {
namespace {

/// Types of all values of a glTF 2.0 file that the readers use. tinygltf leaves out a value of another type.
constexpr char kSchema[] = R"({
  "definitions": {
    "text": {"type": "string"},
    "index": {"type": "integer", "minimum": 0},
    "indices": {"type": "array", "items": {"$ref": "#/definitions/index"}},
    "index_by_name": {"type": "object", "additionalProperties": {"$ref": "#/definitions/index"}},
    "numbers": {"type": "array", "items": {"type": "number"}},
    "numbers3": {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3},
    "numbers4": {"type": "array", "items": {"type": "number"}, "minItems": 4, "maxItems": 4},
    "numbers16": {"type": "array", "items": {"type": "number"}, "minItems": 16, "maxItems": 16},
    "primitive": {"type": "object", "required": ["attributes"], "properties": {
      "attributes": {"$ref": "#/definitions/index_by_name"},
      "targets": {"type": "array", "items": {"$ref": "#/definitions/index_by_name"}},
      "indices": {"$ref": "#/definitions/index"},
      "material": {"$ref": "#/definitions/index"},
      "mode": {"$ref": "#/definitions/index"}}}
  },
  "type": "object", "required": ["asset"], "properties": {
    "asset": {"type": "object", "required": ["version"], "properties": {
      "version": {"$ref": "#/definitions/text"},
      "minVersion": {"$ref": "#/definitions/text"}}},
    "extensionsUsed": {"type": "array", "items": {"$ref": "#/definitions/text"}},
    "extensionsRequired": {"type": "array", "items": {"$ref": "#/definitions/text"}},
    "scene": {"$ref": "#/definitions/index"},
    "scenes": {"type": "array", "items": {"type": "object", "properties": {"nodes": {"$ref": "#/definitions/indices"}}}},
    "nodes": {"type": "array", "items": {"type": "object", "properties": {
      "name": {"$ref": "#/definitions/text"},
      "children": {"$ref": "#/definitions/indices"},
      "mesh": {"$ref": "#/definitions/index"},
      "skin": {"$ref": "#/definitions/index"},
      "matrix": {"$ref": "#/definitions/numbers16"},
      "translation": {"$ref": "#/definitions/numbers3"},
      "rotation": {"$ref": "#/definitions/numbers4"},
      "scale": {"$ref": "#/definitions/numbers3"},
      "weights": {"$ref": "#/definitions/numbers"}}}},
    "meshes": {"type": "array", "items": {"type": "object", "required": ["primitives"], "properties": {
      "name": {"$ref": "#/definitions/text"},
      "weights": {"$ref": "#/definitions/numbers"},
      "primitives": {"type": "array", "items": {"$ref": "#/definitions/primitive"}}}}},
    "materials": {"type": "array", "items": {"type": "object", "properties": {"name": {"$ref": "#/definitions/text"}}}},
    "skins": {"type": "array", "items": {"type": "object", "required": ["joints"], "properties": {
      "inverseBindMatrices": {"$ref": "#/definitions/index"},
      "joints": {"$ref": "#/definitions/indices"}}}},
    "accessors": {"type": "array", "items": {"type": "object", "required": ["componentType", "count", "type"], "properties": {
      "bufferView": {"$ref": "#/definitions/index"},
      "byteOffset": {"$ref": "#/definitions/index"},
      "componentType": {"$ref": "#/definitions/index"},
      "normalized": {"type": "boolean"},
      "count": {"$ref": "#/definitions/index"},
      "type": {"$ref": "#/definitions/text"},
      "sparse": {"type": "object"}}}},
    "bufferViews": {"type": "array", "items": {"type": "object", "required": ["buffer", "byteLength"], "properties": {
      "buffer": {"$ref": "#/definitions/index"},
      "byteOffset": {"$ref": "#/definitions/index"},
      "byteLength": {"$ref": "#/definitions/index"},
      "byteStride": {"$ref": "#/definitions/index"}}}},
    "buffers": {"type": "array", "items": {"type": "object", "required": ["byteLength"], "properties": {
      "byteLength": {"$ref": "#/definitions/index"},
      "uri": {"$ref": "#/definitions/text"}}}}
  }
})";

constexpr std::uintmax_t kMostBytes = 256u << 20;

template <class Item>
Item item_at(const unsigned char* from) {
  Item item;
  std::memcpy(&item, from, sizeof(Item));
  return item;
}

Eigen::Affine3d local_transform(const tinygltf::Node& node) {
  if (node.matrix.size() == 16) return Eigen::Affine3d(Eigen::Map<const Eigen::Matrix4d>(node.matrix.data()));
  Eigen::Affine3d t = Eigen::Affine3d::Identity();
  if (node.translation.size() == 3) t.translate(Vector::Map(node.translation.data()));
  if (node.rotation.size() == 4)
    t.rotate(Eigen::Quaterniond(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]).normalized());
  if (node.scale.size() == 3) t.scale(Vector::Map(node.scale.data()));
  return t;
}

/// Images are not needed and this build cannot decode them, so each stays empty.
bool leave_image(tinygltf::Image*, int, std::string*, std::string*, int, int, const unsigned char*, int, void*) {
  return true;
}

/// Extensions that change no position: a file may require them.
bool is_appearance(const std::string& extension) {
  static const std::vector<std::string> kNames = {"KHR_lights_punctual", "KHR_texture_basisu", "KHR_texture_transform",
                                                  "EXT_texture_webp",    "EXT_texture_avif",   "KHR_xmp_json_ld"};
  return extension.starts_with("KHR_materials_") || contains(kNames, extension);
}

/// The JSON part of a file, with every value of the type that it should have.
nlohmann::json checked_json(const std::string& text, const std::string& source) {
  nlohmann::json parsed = parse_json(text, source);
  validate_json(parsed, kSchema, source);
  return parsed;
}

/// glTF 2.0, sections 3.2 and 3.12: what a reader that is right must not ignore.
void check_header(const tinygltf::Model& model, const std::string& source) {
  const tinygltf::Asset& asset = model.asset;
  if (!asset.minVersion.empty() && asset.minVersion != "2.0")
    fail(source, fmt::format("/asset/minVersion: {}; expected a file that a reader of \"2.0\" can read",
                             in_quotes(asset.minVersion)));
  if (!asset.version.starts_with("2."))
    fail(source, fmt::format("/asset/version: {}; expected \"2.0\"", in_quotes(asset.version)));
  for (std::size_t k = 0; k < model.extensionsRequired.size(); ++k)
    if (!is_appearance(model.extensionsRequired[k]))
      fail(source, fmt::format("/extensionsRequired/{}: {} is not supported; expected a file that does not need it", k,
                               in_quotes(model.extensionsRequired[k])));
}

template <class Load>
tinygltf::Model loaded(const std::string& source, const char* kind, Load load) {
  tinygltf::TinyGLTF loader;
  loader.SetImageLoader(leave_image, nullptr);
  tinygltf::Model model;
  std::string error, warning;
  bool ok = false;
  try {
    ok = load(loader, model, error, warning);
  } catch (const std::exception& e) {
    error = e.what();
  }
  while (!error.empty() && error.back() == '\n') error.pop_back();
  // The library's text may hold the file's.
  if (!ok) fail(source, fmt::format("not a {}: {}", kind, error.empty() ? "unreadable" : shortened(error, 200)));
  check_header(model, source);
  return model;
}

}  // namespace

void fail(const std::string& source, const std::string& message) { throw Error(source + ": " + message); }

std::vector<double> numbers(const tinygltf::Model& model, int index, int type, std::initializer_list<int> kinds,
                            const std::string& source, const char* expected) {
  const auto& accessor = pick(model.accessors, index, source, "accessors");
  const std::string where = fmt::format("/accessors/{}", index);
  if (accessor.type != type || std::find(kinds.begin(), kinds.end(), accessor.componentType) == kinds.end())
    fail(source, fmt::format("{}: type {} of component type {}: expected the types of {}", where, accessor.type,
                             accessor.componentType, expected));
  if (accessor.sparse.isSparse || accessor.normalized)
    fail(source, where + ": expected an accessor that is neither sparse nor normalized");
  const auto& view = pick(model.bufferViews, accessor.bufferView, source, "bufferViews");
  const auto& buffer = pick(model.buffers, view.buffer, source, "buffers");
  const auto components = static_cast<std::size_t>(tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(type)));
  const auto item =
      static_cast<std::size_t>(tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(accessor.componentType)));
  const std::size_t row = components * item, stride = view.byteStride == 0 ? row : view.byteStride;
  const std::size_t size = buffer.data.size();
  if (view.byteOffset > size || view.byteLength > size - view.byteOffset || accessor.byteOffset > view.byteLength ||
      stride < row || stride > 252 || accessor.count == 0 || accessor.count > view.byteLength ||
      accessor.byteOffset + (accessor.count - 1) * stride + row > view.byteLength)
    fail(source, where + ": expected at least one item and no more than its buffer view holds");
  std::vector<double> out;
  out.reserve(accessor.count * components);
  for (std::size_t i = 0; i < accessor.count; ++i)
    for (std::size_t k = 0; k < components; ++k) {
      const unsigned char* from = buffer.data.data() + view.byteOffset + accessor.byteOffset + i * stride + k * item;
      switch (accessor.componentType) {
        case TINYGLTF_COMPONENT_TYPE_FLOAT:
          out.push_back(item_at<float>(from));
          break;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
          out.push_back(*from);
          break;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
          out.push_back(item_at<std::uint16_t>(from));
          break;
        default:
          out.push_back(item_at<std::uint32_t>(from));
          break;
      }
      if (!std::isfinite(out.back())) fail(source, fmt::format("{}: item {} is not finite", where, i));
    }
  return out;
}

std::vector<Eigen::Affine3d> world_transforms(const tinygltf::Model& model, const std::string& source) {
  std::vector<int> parent(model.nodes.size(), -1);
  for (std::size_t n = 0; n < model.nodes.size(); ++n)
    for (int child : model.nodes[n].children) {
      pick(model.nodes, child, source, "nodes");
      if (parent[static_cast<std::size_t>(child)] != -1) fail(source, fmt::format("/nodes/{}: has two parents", child));
      parent[static_cast<std::size_t>(child)] = static_cast<int>(n);
    }
  std::vector<Eigen::Affine3d> world(model.nodes.size());
  for (std::size_t n = 0; n < model.nodes.size(); ++n) {
    Eigen::Affine3d t = Eigen::Affine3d::Identity();
    std::size_t steps = 0;
    for (int at = static_cast<int>(n); at != -1; at = parent[static_cast<std::size_t>(at)]) {
      if (++steps > model.nodes.size()) fail(source, fmt::format("/nodes/{}: is its own ancestor", n));
      t = local_transform(model.nodes[static_cast<std::size_t>(at)]) * t;
    }
    world[n] = t;
  }
  return world;
}

tinygltf::Model parse_binary(const std::string& content, const std::string& source) {
  const auto* bytes = reinterpret_cast<const unsigned char*>(content.data());
  const std::size_t size = content.size();
  constexpr std::uint32_t kVersion = 2;
  if (size >= 12 && item_at<std::uint32_t>(bytes + 4) != kVersion)
    fail(source, fmt::format("not a binary glTF file of version {}: its version is {}", kVersion,
                             item_at<std::uint32_t>(bytes + 4)));
  constexpr std::size_t kText = 20;  // after the file's header and the chunk's length and type
  if (size >= kText && std::memcmp(bytes + 16, "JSON", 4) == 0 && item_at<std::uint32_t>(bytes + 12) <= size - kText)
    checked_json(content.substr(kText, item_at<std::uint32_t>(bytes + 12)), source);
  return loaded(source, "binary glTF file (cut off?)", [&](auto& loader, auto& model, auto& error, auto& warning) {
    if (size >= 12 && size <= kMostBytes)
      return loader.LoadBinaryFromMemory(&model, &error, &warning, bytes, static_cast<unsigned>(size), "");
    error = fmt::format("{} bytes", size);
    return false;
  });
}

tinygltf::Model parse_text(const std::string& text, const std::string& source) {
  const nlohmann::json parsed = checked_json(text, source);
  // The library would open any file that the text names; the hash of a scene's mesh would not include it.
  const nlohmann::json buffers = parsed.value("buffers", nlohmann::json::array());
  for (std::size_t k = 0; k < buffers.size(); ++k)
    if (!buffers[k].value("uri", "").starts_with("data:"))
      fail(source, fmt::format("/buffers/{}/uri: expected the buffer inside the file: a data URI, or a .glb file", k));
  return loaded(source, "glTF file", [&](auto& loader, auto& model, auto& error, auto& warning) {
    return loader.LoadASCIIFromString(&model, &error, &warning, text.data(), static_cast<unsigned>(text.size()), "");
  });
}

}  // namespace clothbench::assets::gltf
