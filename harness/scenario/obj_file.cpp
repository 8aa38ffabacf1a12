#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <sstream>
#include <utility>

#include "base/words.hpp"
#include "clothbench/error.hpp"
#include "scenario/cloth_mesh.hpp"

#define TINYOBJLOADER_IMPLEMENTATION
#define TINYOBJLOADER_USE_DOUBLE
#include <tiny_obj_loader.h>

namespace clothbench {
namespace {

using Words = std::vector<std::string>;

[[noreturn]] void refuse_line(const std::string& source, std::uint32_t line, const std::string& what) {
  throw Error(fmt::format("{}: line {}: {}", source, line, what));
}

/// The statements of a file that define geometry and names, one a line, and the lines on which they began.
struct Statements {
  std::string text;
  std::vector<std::uint32_t> vertices, faces;
};

/// The OBJ library reads any other word as 0, so a NaN would count as a position; it reads hexadecimal digits as 0 too.
void check_numbers(const Words& words, std::size_t least, std::size_t most, const std::string& source,
                   std::uint32_t line) {
  if (words.size() <= least)
    refuse_line(source, line, fmt::format("expected {} numbers after \"{}\"", least, words[0]));
  for (std::size_t k = 1; k < words.size() && k <= most; ++k) {
    char* end = nullptr;
    if (!std::isfinite(std::strtod(words[k].c_str(), &end)) || *end != 0 ||
        words[k].find_first_of("xX") != std::string::npos)
      refuse_line(source, line, fmt::format("{}: expected a finite decimal number", in_quotes(words[k])));
  }
}

/// Corners are 1, 1/2, 1//3 or 1/2/3. The library would read the start of any other word, or overflow.
void check_corners(const Words& words, const std::string& source, std::uint32_t line) {
  constexpr std::size_t kMostDigits = 9;
  if (words.size() < 4) refuse_line(source, line, "expected at least three corners of a face");
  for (std::size_t k = 1; k < words.size(); ++k) {
    bool good = std::count(words[k].begin(), words[k].end(), '/') <= 2;
    std::size_t length = 0;
    for (const char c : words[k]) {
      good = good && (c == '/' || (c == '-' && length == 0) || (c >= '0' && c <= '9' && length < kMostDigits));
      length = c == '/' ? 0 : length + 1;
    }
    if (!good)
      refuse_line(source, line,
                  fmt::format("{}: expected the numbers of a vertex, as in 1, 1/2 or 1/2/3", in_quotes(words[k])));
  }
}

/// Joins continued lines and drops the mark of UTF-8, comments, and all content that is no geometry (materials, skin
/// weights, curves): it is untrusted and stays unread. A lone carriage return ends a line too, as in the OBJ library.
Statements statements_of(std::string_view text, const std::string& source) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  std::string lines;
  for (std::size_t k = 0; k < text.size(); ++k)
    if (text[k] != '\r' || k + 1 == text.size() || text[k + 1] != '\n') lines += text[k] == '\r' ? '\n' : text[k];
  Statements out;
  std::istringstream in(lines);
  std::string line, statement;
  for (std::uint32_t number = 1, first = 1; std::getline(in, line); ++number) {
    if (statement.empty()) first = number;
    for (std::size_t at = line.find('#'); at != std::string::npos; at = line.find('#', at + 1))
      if (at == 0 || std::isspace(static_cast<unsigned char>(line[at - 1])) != 0) line.resize(at);  // else of a name
    while (!line.empty() && std::isspace(static_cast<unsigned char>(line.back())) != 0) line.pop_back();
    const bool goes_on = line.ends_with('\\');
    if (goes_on) line.back() = ' ';
    statement += line;
    if (goes_on && in.peek() != std::istringstream::traits_type::eof()) continue;
    std::istringstream split(std::exchange(statement, ""));
    const Words words{std::istream_iterator<std::string>(split), {}};
    if (words.empty()) continue;
    if (words[0] == "v") {
      check_numbers(words, 3, 3, source, first);
      out.vertices.push_back(first);
    } else if (words[0] == "f") {
      check_corners(words, source, first);
      out.faces.push_back(first);
    } else if (words[0] != "g" && words[0] != "o") {
      continue;
    }
    out.text += fmt::format("{}{}\n", fmt::join(words, " "), words.size() == 1 ? " " : "");  // as the library needs it
  }
  return out;
}

struct Face {
  std::vector<std::uint32_t> corners;  ///< vertices
  Words names;                         ///< its groups, and its object
  std::uint32_t line;
};

/// Receives what the library reads. An index counts from 1, or backwards from the last item so far if it is negative.
struct Reader {
  const std::string& source;
  const Statements& statements;
  assets::MeshFile& out;
  std::vector<Face> faces = {};
  Words groups = {};
  std::string object = {};

  std::uint32_t vertex(int index) const {
    const auto n = static_cast<std::int64_t>(out.vertices.size()), k = index < 0 ? n + index : index - std::int64_t{1};
    if (k >= 0 && k < n) return static_cast<std::uint32_t>(k);
    refuse_line(source, statements.faces[faces.size()],
                fmt::format("vertex {} of {} before it (the first is 1)", index, n));
  }

  void add_face(const tinyobj::index_t* indices, int count) {
    Face face{{}, groups, statements.faces[faces.size()]};
    for (int k = 0; k < count; ++k) face.corners.push_back(vertex(indices[k].vertex_index));
    if (!object.empty() && !contains(face.names, object)) face.names.push_back(object);
    faces.push_back(std::move(face));
  }

  void add_triangles(const Face& face) {
    std::vector<Vec3> at;
    for (const std::uint32_t c : face.corners) at.push_back(out.vertices[c]);
    using Triangles = std::vector<std::array<std::uint32_t, 3>>;
    for (const auto& t :
         at.size() == 3 ? Triangles{{0, 1, 2}} : triangulated(at, fmt::format("{}: line {}", source, face.line))) {
      for (const std::string& name : face.names)
        out.groups[name].push_back(static_cast<std::uint32_t>(out.triangles.size()));
      out.triangles.push_back({face.corners[t[0]], face.corners[t[1]], face.corners[t[2]]});
      out.triangle_lines.push_back(face.line);
    }
  }
};

tinyobj::callback_t callbacks() {
  tinyobj::callback_t c;
  c.vertex_cb = [](void* to, double x, double y, double z, double) {
    static_cast<Reader*>(to)->out.vertices.push_back({x, y, z});
  };
  c.index_cb = [](void* to, tinyobj::index_t* indices, int count) {
    static_cast<Reader*>(to)->add_face(indices, count);
  };
  c.group_cb = [](void* to, const char** names, int count) {
    static_cast<Reader*>(to)->groups.assign(names, names + count);
  };
  c.object_cb = [](void* to, const char* name) { static_cast<Reader*>(to)->object = name; };
  return c;
}

}  // namespace

assets::MeshFile read_obj(const std::string& text, const std::string& source) {
  assets::MeshFile out;
  Statements statements = statements_of(text, source);
  out.vertex_lines = statements.vertices;
  Reader reader{source, statements, out};
  std::istringstream in(statements.text);
  tinyobj::LoadObjWithCallback(in, callbacks(), &reader);
  for (const Face& face : reader.faces) reader.add_triangles(face);
  return out;
}

}  // namespace clothbench
