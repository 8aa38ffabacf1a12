// Wavefront OBJ: positions, faces and the names of faces. All other content (textures, materials, skin weights, curves)
// is ignored.
#include <fmt/format.h>

#include <cctype>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <sstream>
#include <utility>

#include "base/words.hpp"
#include "clothbench/error.hpp"
#include "clothbench/vector.hpp"
#include "scenario/cloth_mesh.hpp"

namespace clothbench {
namespace {

using Words = std::vector<std::string>;

/// The file's lines without the mark of UTF-8. A carriage return ends a line with or without a line feed.
std::string lines_of(std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  std::string out;
  for (std::size_t k = 0; k < text.size(); ++k)
    if (text[k] != '\r' || k + 1 == text.size() || text[k + 1] != '\n') out += text[k] == '\r' ? '\n' : text[k];
  return out;
}

bool is_space(char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; }

/// Drops the comment of a line, and spaces at its end. A # inside a word belongs to the word.
void strip(std::string& line) {
  for (std::size_t at = line.find('#'); at != std::string::npos; at = line.find('#', at + 1))
    if (at == 0 || is_space(line[at - 1])) line.resize(at);
  while (!line.empty() && is_space(line.back())) line.pop_back();
}

class ObjReader {
 public:
  ObjReader(const std::string& source, assets::MeshFile& out) : source_(source), out_(out) {}

  /// Executes one statement, which begins on this line of the file.
  void read(const Words& words, std::uint32_t line) {
    line_ = line;
    if (words[0] == "v") add_vertex(words);
    if (words[0] == "f") add_face(words);
    if (words[0] == "g") groups_.assign(words.begin() + 1, words.end());
    if (words[0] == "o") object_ = joined(Words(words.begin() + 1, words.end()), " ");
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const {
    throw Error(fmt::format("{}: line {}: {}", source_, line_, what));
  }

  void add_vertex(const Words& words) {
    if (words.size() < 4) refuse("expected 3 numbers after \"v\"");
    Vec3 x{};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::string& word = words[k + 1];
      char* end = nullptr;
      x[k] = std::strtod(word.c_str(), &end);
      if (!std::isfinite(x[k]) || *end != 0 || word.find_first_of("xX") != std::string::npos)
        refuse(in_quotes(word) + ": expected a finite decimal number");
    }
    out_.vertices.push_back(x);
    out_.vertex_lines.push_back(line_);
  }

  /// The vertex of a corner, which is 1, 1/2, 1//3 or 1/2/3. It counts from 1, or backwards from the last vertex so far
  /// if it is negative.
  std::uint32_t vertex_of(const std::string& word) const {
    constexpr std::size_t kMaxDigits = 9;
    const std::string number = word.substr(0, word.find('/'));
    const std::size_t sign = number.starts_with('-') ? 1 : 0;
    if (number.size() == sign || number.size() > sign + kMaxDigits ||
        number.find_first_not_of("0123456789", sign) != std::string::npos ||
        word.find_first_not_of("-/0123456789") != std::string::npos)
      refuse(in_quotes(word) + ": expected the numbers of a vertex, as in 1, 1/2 or 1/2/3");
    const long index = std::stol(number), n = static_cast<long>(out_.vertices.size()),
               k = index < 0 ? n + index : index - 1;
    if (k < 0 || k >= n) refuse(fmt::format("vertex {} of {} before it (the first is 1)", index, n));
    return static_cast<std::uint32_t>(k);
  }

  /// Cuts a convex face into triangles that share its first corner.
  void add_face(const Words& words) {
    if (words.size() < 4) refuse("expected at least three corners of a face");
    std::vector<std::uint32_t> corners;
    for (std::size_t k = 1; k < words.size(); ++k) corners.push_back(vertex_of(words[k]));
    const Vec3& first = out_.vertices[corners[0]];
    const auto area = [&](std::size_t k) {
      return cross(minus(out_.vertices[corners[k]], first), minus(out_.vertices[corners[k + 1]], first));
    };
    Vec3 normal{};
    for (std::size_t k = 1; k + 1 < corners.size(); ++k) normal = plus(normal, area(k));
    for (std::size_t k = 1; k + 1 < corners.size(); ++k) {
      if (corners.size() > 3 && !(dot(area(k), normal) > 0))
        refuse(
            fmt::format("a face of {} corners that is not convex; expected triangles or convex faces: triangulate "
                        "the mesh in the program that exports it",
                        corners.size()));
      add_triangle({corners[0], corners[k], corners[k + 1]});
    }
  }

  void add_triangle(const std::array<std::uint32_t, 3>& corners) {
    const auto number = static_cast<std::uint32_t>(out_.triangles.size());
    for (const std::string& name : groups_) out_.groups[name].push_back(number);
    if (!object_.empty() && !contains(groups_, object_)) out_.groups[object_].push_back(number);
    out_.triangles.push_back(corners);
    out_.triangle_lines.push_back(line_);
  }

  const std::string& source_;
  assets::MeshFile& out_;
  std::uint32_t line_ = 0;
  Words groups_;
  std::string object_;
};

}  // namespace

assets::MeshFile read_obj(const std::string& text, const std::string& source) {
  assets::MeshFile out;
  ObjReader reader(source, out);
  std::istringstream in(lines_of(text));
  std::string line, statement;
  for (std::uint32_t number = 1, first = 1; std::getline(in, line); ++number) {
    if (statement.empty()) first = number;
    strip(line);
    const bool continues = line.ends_with('\\');
    if (continues) line.back() = ' ';
    statement += line;
    if (continues && in.peek() != std::istringstream::traits_type::eof()) continue;
    std::istringstream split(std::exchange(statement, ""));
    const Words words{std::istream_iterator<std::string>(split), {}};
    if (!words.empty()) reader.read(words, first);
  }
  return out;
}

}  // namespace clothbench
