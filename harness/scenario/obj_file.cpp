#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <limits>
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

/// A file's statements that define geometry and names, one per line, and their line numbers in the file.
struct Statements {
  std::string text;
  std::vector<std::uint32_t> vertices, faces;
};

/// Checks numbers, because the OBJ library reads any other word, NaN and hexadecimal digits included, as 0.
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

/// Checks corners: 1, 1/2, 1//3 or 1/2/3. The library reads only the start of other words, or overflows.
void check_corners(const Words& words, const std::string& source, std::uint32_t line) {
  constexpr std::size_t kMostDigits = 9;
  if (words.size() < 4) refuse_line(source, line, "expected at least three corners in a face");
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

/// Joins continued lines and drops the UTF-8 mark, comments, and all statements other than geometry (materials, skin
/// weights, curves), because the input is untrusted. A lone carriage return also ends a line, as in the OBJ library.
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
      if (at == 0 || std::isspace(static_cast<unsigned char>(line[at - 1])) != 0) line.resize(at);  // if not in a name
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
    out.text += fmt::format("{}{}\n", fmt::join(words, " "), words.size() == 1 ? " " : "");  // tinyobj needs the space
  }
  return out;
}

struct Face {
  std::vector<std::uint32_t> corners;  ///< vertices
  Words names;                         ///< its groups and its object
  std::uint32_t line;
};

/// Receives the library's output. An index counts from 1; a negative one counts back from the last item so far.
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
                fmt::format("vertex {}: expected one of the {} before it (the first is 1)", index, n));
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

using Point = std::array<double, 2>;

/// Twice the signed area of a triangle; 0 if the difference is within its rounding error.
double turn(const Point& a, const Point& b, const Point& c) {
  constexpr double kRounding = 4 * std::numeric_limits<double>::epsilon();
  const double left = (b[0] - a[0]) * (c[1] - a[1]), right = (b[1] - a[1]) * (c[0] - a[0]);
  return std::abs(left - right) <= kRounding * (std::abs(left) + std::abs(right)) ? 0 : left - right;
}

double square(const Point& a, const Point& b) { return std::pow(b[0] - a[0], 2) + std::pow(b[1] - a[1], 2); }

/// Whether c, collinear with a and b, lies between them or on one of them.
bool between(const Point& a, const Point& b, const Point& c) {
  return std::min(a[0], b[0]) <= c[0] && c[0] <= std::max(a[0], b[0]) && std::min(a[1], b[1]) <= c[1] &&
         c[1] <= std::max(a[1], b[1]);
}

/// Whether two segments have a point in common.
bool meet(const Point& a, const Point& b, const Point& c, const Point& d) {
  const double abc = turn(a, b, c), abd = turn(a, b, d), cda = turn(c, d, a), cdb = turn(c, d, b);
  return (abc * abd < 0 && cda * cdb < 0) || (abc == 0 && between(a, b, c)) || (abd == 0 && between(a, b, d)) ||
         (cda == 0 && between(c, d, a)) || (cdb == 0 && between(c, d, b));
}

/// Projection of a polygon along the axis nearest to its normal, counter-clockwise. Dropping a coordinate does not
/// round, so collinear corners stay collinear.
std::vector<Point> seen_along_normal(const std::vector<Vec3>& corners) {
  Vec3 normal{};
  for (std::size_t k = 1; k + 1 < corners.size(); ++k)
    normal = plus(normal, cross(minus(corners[k], corners[0]), minus(corners[k + 1], corners[0])));
  std::size_t axis = 0;
  for (std::size_t k = 1; k < 3; ++k)
    if (std::abs(normal[k]) > std::abs(normal[axis])) axis = k;
  const std::size_t first = (axis + (normal[axis] > 0 ? 1 : 2)) % 3, second = (axis + (normal[axis] > 0 ? 2 : 1)) % 3;
  std::vector<Point> out;
  for (const Vec3& x : corners) out.push_back({x[first], x[second]});
  return out;
}

/// The first side that meets another one (neighbours may share only their corner); the number of sides if none does.
std::size_t crossing_side(const std::vector<Point>& p) {
  const std::size_t n = p.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Point &a = p[i], &b = p[(i + 1) % n], &after = p[(i + 2) % n];
    if (turn(a, b, after) == 0 && (between(b, after, a) || between(a, b, after))) return i;  // it turns back
    for (std::size_t j = i + 2; j < n; ++j)
      if ((j + 1) % n != i && meet(a, b, p[j], p[(j + 1) % n])) return i;
  }
  return n;
}

/// Cuts off ears until one triangle is left.
class Clipping {
 public:
  Clipping(const std::vector<Point>& points, double flat) : p_(points), flat_(flat) {
    for (std::uint32_t k = 0; k < p_.size(); ++k) left_.push_back(k);
  }

  /// False if no ear was found.
  bool cut(std::vector<std::array<std::uint32_t, 3>>& triangles) {
    triangles.clear();
    while (left_.size() > 2) {
      std::size_t best = left_.size();
      double most = 0;
      for (std::size_t k = 0; k < left_.size(); ++k)
        if (const double q = quality(k); q > most && is_ear(k)) {
          best = k;
          most = q;
        }
      if (best == left_.size()) return false;
      triangles.push_back({at(best + left_.size() - 1), at(best), at(best + 1)});
      left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(best));
    }
    return true;
  }

 private:
  std::uint32_t at(std::size_t k) const { return left_[k % left_.size()]; }

  /// Twice the area of a corner's triangle over the square of its longest side; 0 if the corner is not convex.
  double quality(std::size_t k) const {
    const Point &a = p_[at(k + left_.size() - 1)], &b = p_[at(k)], &c = p_[at(k + 1)];
    const double q = turn(a, b, c) / std::max({square(a, b), square(b, c), square(c, a)});
    return q > flat_ ? q : 0;
  }

  /// Whether no other corner lies inside the triangle of corner k and its two neighbours, or on the triangle's border.
  bool is_ear(std::size_t k) const {
    const std::array<std::uint32_t, 3> t = {at(k + left_.size() - 1), at(k), at(k + 1)};
    const Point &a = p_[t[0]], &b = p_[t[1]], &c = p_[t[2]];
    const double near = -flat_ * std::max({square(a, b), square(b, c), square(c, a)});
    return std::none_of(left_.begin(), left_.end(), [&](std::uint32_t v) {
      return v != t[0] && v != t[1] && v != t[2] && turn(a, b, p_[v]) >= near && turn(b, c, p_[v]) >= near &&
             turn(c, a, p_[v]) >= near;
    });
  }

  const std::vector<Point>& p_;
  const double flat_;
  std::vector<std::uint32_t> left_;
};

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

// Written here because Debian has no earcut, CGAL's triangulations are GPL, and tinyobjloader's polygon code cuts
// outside concave faces.
std::vector<std::array<std::uint32_t, 3>> triangulated(const std::vector<Vec3>& corners, const std::string& where) {
  if (corners.size() > kMostCorners)
    throw Error(fmt::format("{}: a face of {} corners; expected at most {}", where, corners.size(), kMostCorners));
  std::vector<std::uint32_t> number;  // index of each corner that differs from the one before it
  std::vector<Vec3> kept;
  for (std::uint32_t k = 0; k < corners.size(); ++k)
    if (kept.empty() || (corners[k] != kept.back() && (k + 1 < corners.size() || corners[k] != kept.front()))) {
      number.push_back(k);
      kept.push_back(corners[k]);
    }
  const std::vector<Point> points = seen_along_normal(kept);
  double area = 0;
  for (std::size_t k = 1; k + 1 < points.size(); ++k) area += turn(points[0], points[k], points[k + 1]);
  if (!(area > 0)) throw Error(where + ": a face that has no area");
  if (const std::size_t side = crossing_side(points); side < points.size())
    throw Error(
        fmt::format("{}: the outline of the face crosses or touches itself at the side from corner {}; "
                    "expected a simple polygon",
                    where, number[side] + 1));
  // Triangles thinner than the first limit are cut only if there is no other ear.
  std::vector<std::array<std::uint32_t, 3>> out;
  if (!Clipping(points, 1e-6).cut(out) && !Clipping(points, 0).cut(out))
    throw Error(where + ": the face is too thin to be cut into triangles");
  for (auto& t : out)
    for (std::uint32_t& v : t) v = number[v];
  return out;
}

}  // namespace clothbench
