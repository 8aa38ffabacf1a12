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

// Access to the parts of a glTF file, with the checks that tinygltf leaves to its callers.
namespace clothbench::assets::gltf {

/// Throws Error "<source>: <message>".
[[noreturn]] void fail(const std::string& source, const std::string& message);

/// Element of a list by an index from a file; throws if the index is out of range.
template <class List>
const auto& pick(const List& list, int index, const std::string& source, const char* what) {
  if (index < 0 || static_cast<std::size_t>(index) >= list.size())
    fail(source, fmt::format("/{}: index {}: expected less than {}", what, index, list.size()));
  return list[static_cast<std::size_t>(index)];
}

/// One accessor as plain numbers, (count, components) row-major. `expected`: whose types it must have, for the message.
std::vector<double> numbers(const tinygltf::Model&, int index, int type, std::initializer_list<int> kinds,
                            const std::string& source, const char* expected);

/// World transforms of all nodes; a node that is its own ancestor, or has two parents, is refused.
std::vector<Eigen::Affine3d> world_transforms(const tinygltf::Model&, const std::string& source);

/// A binary file. Images in it are not decoded.
tinygltf::Model parse_binary(const std::string& bytes, const std::string& source);
/// A text file; its buffers must be inside it, as data URIs.
tinygltf::Model parse_text(const std::string& text, const std::string& source);

}  // namespace clothbench::assets::gltf
