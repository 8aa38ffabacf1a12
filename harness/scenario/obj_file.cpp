#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <sstream>

#include "base/words.hpp"
#include "clothbench/error.hpp"
#include "scenario/cloth_mesh.hpp"

#define TINYOBJLOADER_IMPLEMENTATION
#define TINYOBJLOADER_USE_DOUBLE
#include <tiny_obj_loader.h>

namespace clothbench {
namespace {

/// The lines of a file that define geometry, and the names that its faces have.
struct ObjLines {
  std::string text;  ///< every group of faces is "g <number>"
  std::vector<std::vector<std::string>> names;
};

/// Words of the rest of a line.
std::vector<std::string> words_of(std::istringstream& line) {
  std::vector<std::string> out;
  for (std::string word; line >> word;) out.push_back(word);
  return out;
}

/// The OBJ library reads any other word as 0, so a NaN would count as a position.
void check_numbers(const std::string& line, std::size_t number, std::size_t most, const std::string& source) {
  std::istringstream words(line);
  std::string word;
  words >> word;
  for (std::size_t k = 0; k < most && words >> word; ++k) {
    char* end = nullptr;
    if (!std::isfinite(std::strtod(word.c_str(), &end)) || end != word.c_str() + word.size())
      throw Error(fmt::format("{}: line {}: \"{}\": expected a finite number", source, number, word));
  }
}

/// A lone carriage return ends a line too, as in the OBJ library. An object's name is the rest of its line; a group
/// line has several names, one a word, and a face belongs to all of them and to its object. All other content
/// (materials, skin weights, curves) is untrusted and dropped unread.
ObjLines geometry_of(const std::string& text, const std::string& source) {
  ObjLines out;
  std::string lines = text, line, object;
  std::replace(lines.begin(), lines.end(), '\r', '\n');
  std::vector<std::string> groups;
  std::istringstream in(lines);
  for (std::size_t number = 1; std::getline(in, line); ++number) {
    std::istringstream words(line);
    std::string first;
    words >> first;
    if (first == "v" || first == "vt") check_numbers(line, number, first == "v" ? 3 : 2, source);
    if (first == "v" || first == "vt" || first == "vn" || first == "f") {
      out.text += line + "\n";
      continue;
    }
    if (first != "g" && first != "o") continue;
    const std::vector<std::string> rest = words_of(words);
    if (first == "g")
      groups = rest;
    else
      object = fmt::format("{}", fmt::join(rest, " "));
    out.text += fmt::format("g {}\n", out.names.size());
    std::vector<std::string>& names = out.names.emplace_back(groups);
    if (!object.empty() && !contains(names, object)) names.push_back(object);
  }
  return out;
}

}  // namespace

assets::MeshFile read_obj(const std::string& text, const std::string& source) {
  tinyobj::attrib_t attributes;
  std::vector<tinyobj::shape_t> shapes;
  std::vector<tinyobj::material_t> materials;
  std::string warning, error;
  const ObjLines lines = geometry_of(text, source);
  std::istringstream in(lines.text);
  if (!tinyobj::LoadObj(&attributes, &shapes, &materials, &warning, &error, &in))
    throw Error(fmt::format("{}: expected an OBJ file: {}", source, error.empty() ? "it cannot be read" : error));
  assets::MeshFile out;
  for (std::size_t k = 0; k + 2 < attributes.vertices.size(); k += 3)
    out.vertices.push_back({attributes.vertices[k], attributes.vertices[k + 1], attributes.vertices[k + 2]});
  for (const tinyobj::shape_t& shape : shapes)
    for (std::size_t k = 0; k + 2 < shape.mesh.indices.size(); k += 3) {
      std::array<std::uint32_t, 3> t{};
      assets::TextureTriangle texture;
      for (std::size_t c = 0; c < 3; ++c) {
        const tinyobj::index_t& at = shape.mesh.indices[k + c];
        t[c] = static_cast<std::uint32_t>(at.vertex_index);
        const auto uv = 2 * static_cast<std::size_t>(at.texcoord_index);
        texture[c].fill(std::numeric_limits<double>::quiet_NaN());
        if (at.texcoord_index >= 0 && uv + 1 < attributes.texcoords.size())
          texture[c] = {attributes.texcoords[uv], attributes.texcoords[uv + 1]};
      }
      if (!shape.name.empty())
        for (const std::string& name : lines.names.at(std::stoul(shape.name)))
          out.groups[name].push_back(static_cast<std::uint32_t>(out.triangles.size()));
      out.triangles.push_back(t);
      out.texture.push_back(texture);
    }
  return out;
}

}  // namespace clothbench
