#pragma once
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#define TINYGLTF_NO_INCLUDE_JSON
#include <tiny_gltf.h>

// Access to the parts of a glTF file, with checks that tinygltf leaves to its callers.
namespace clothbench::assets::gltf {

/// Throws Error "<source>: <message>".
[[noreturn]] void fail(const std::string& source, const std::string& message);

/// Element of a list by an index from the file; throws if the index is out of range.
template <class List>
const auto& pick(const List& list, int index, const std::string& source, const char* what) {
  if (index < 0 || static_cast<std::size_t>(index) >= list.size())
    fail(source, fmt::format("/{}: index {}: expected less than {}", what, index, list.size()));
  return list[static_cast<std::size_t>(index)];
}

/// One accessor as numbers, (count, components) row-major. `expected`: name of the allowed types, for the message.
std::vector<double> numbers(const tinygltf::Model&, int index, int type, std::initializer_list<int> kinds,
                            const std::string& source, const char* expected);

/// World transforms of all nodes. Throws if a node is its own ancestor or has two parents.
std::vector<Eigen::Affine3d> world_transforms(const tinygltf::Model&, const std::string& source);

/// Parses a binary file. Images are not decoded.
tinygltf::Model parse_binary(const std::string& bytes, const std::string& source);
/// Parses a text file; its buffers must be inside it as data URIs.
tinygltf::Model parse_text(const std::string& text, const std::string& source);

}  // namespace clothbench::assets::gltf
