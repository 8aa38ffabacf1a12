#include <fmt/format.h>

#include <cctype>

#include "assets/hand_pose.hpp"
#include "assets/json_at.hpp"
#include "base/json_text.hpp"
#include "clothbench/error.hpp"

namespace clothbench::assets {
namespace {

/// Rewrites the first object literal after an '=' as JSON: comments and trailing commas dropped, names and strings in
/// double quotes. Anything but literals comes through as a word, which the JSON parser then refuses.
class LiteralToJson {
 public:
  LiteralToJson(const std::string& text, const std::string& source) : text_(text), source_(source) {}

  std::string convert() {
    at_ = 0;
    while (at_ < text_.size() && text_[at_] != '=')
      if (!skip_blank()) ++at_;
    ++at_;
    while (skip_blank()) {
    }
    if (at_ >= text_.size() || text_[at_] != '{')
      throw Error(source_ + ": no \"= {\": expected a module that exports an object literal");
    int depth = 0;
    do {
      if (at_ >= text_.size()) throw Error(source_ + ": the object literal is not closed (file cut off?)");
      if (skip_blank()) continue;
      token(depth);
    } while (depth > 0);
    return std::move(out_);
  }

 private:
  bool skip_blank() {
    if (at_ >= text_.size()) return false;
    if (std::isspace(static_cast<unsigned char>(text_[at_]))) {
      ++at_;
      return true;
    }
    const bool line = text_.compare(at_, 2, "//") == 0, block = text_.compare(at_, 2, "/*") == 0;
    if (!line && !block) return false;
    const std::size_t end = line ? text_.find('\n', at_) : text_.find("*/", at_ + 2);
    at_ = end == std::string::npos ? text_.size() : end + (line ? 1 : 2);
    return true;
  }

  void token(int& depth) {
    const char c = text_[at_];
    if (c == '\'' || c == '"') return quoted(c);
    if (c == '{' || c == '[') ++depth;
    if (c == '}' || c == ']') {
      --depth;
      if (!out_.empty() && out_.back() == ',') out_.pop_back();
    }
    if (std::string_view("{}[],:").find(c) != std::string_view::npos) {
      out_ += c;
      ++at_;
      return;
    }
    word();
  }

  void quoted(char quote) {
    const std::size_t end = text_.find(quote, at_ + 1);
    const std::string inner = end == std::string::npos ? "\n" : text_.substr(at_ + 1, end - at_ - 1);
    if (inner.find_first_of("\n\\\"") != std::string::npos)
      throw Error(fmt::format("{}: character {}: a string that is not closed or has escapes", source_, at_));
    out_ += '"' + inner + '"';
    at_ = end + 1;
  }

  void word() {
    const std::size_t start = at_;
    while (at_ < text_.size() && (std::isalnum(static_cast<unsigned char>(text_[at_])) ||
                                  std::string_view("_$.+-").find(text_[at_]) != std::string_view::npos))
      ++at_;
    if (at_ == start) throw Error(fmt::format("{}: character {}: '{}' in an object literal", source_, at_, text_[at_]));
    std::string w = text_.substr(start, at_ - start);
    while (skip_blank()) {
    }
    const bool is_name = at_ < text_.size() && text_[at_] == ':';
    if (is_name)
      w = '"' + w + '"';
    else if (w[0] == '+')
      w.erase(0, 1);
    if (!is_name && w[0] == '.') w.insert(0, "0");
    out_ += w;
  }

  const std::string& text_;
  const std::string& source_;
  std::string out_;
  std::size_t at_ = 0;
};

/// 16 numbers, columns first, a rotation and a translation.
Frame frame_at(const JsonAt& at) {
  const Eigen::VectorXd numbers = at.numbers(16);
  const Eigen::Matrix4d m = Eigen::Map<const Eigen::Matrix4d>(numbers.data());
  const Eigen::Matrix3d r = m.topLeftCorner<3, 3>();
  if (!((r.transpose() * r - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() <= 1e-3) || !(r.determinant() > 0) ||
      !(m.row(3) == Eigen::RowVector4d(0, 0, 0, 1)))
    at.fail("expected a rotation and a translation, columns first");
  Frame frame = Frame::Identity();
  frame.linear() = Eigen::Quaterniond(r).normalized().toRotationMatrix();
  frame.translation() = m.topRightCorner<3, 1>();
  return frame;
}

}  // namespace

HandPose parse_pose_js(const std::string& text, const std::string& source) {
  const nlohmann::json document = parse_json(LiteralToJson(text, source).convert(), source + " (as JSON)");
  const JsonAt root(document, source);
  const JsonAt transforms = root.key("jointTransforms");
  HandPose pose;
  for (std::size_t j = 0; j < kJointCount; ++j) {
    const JsonAt joint = transforms.key(std::string(kJointNames[j]));
    pose.joints[j] = frame_at(joint.key("offsetMatrix"));
    const JsonAt radius = joint.key("radius");
    pose.radius_m[j] = radius.number();
    if (!(pose.radius_m[j] > 0 && pose.radius_m[j] < 0.1)) radius.fail("expected a radius between 0 and 0.1 m");
  }
  return pose;
}

HandPose read_pose_js(const std::filesystem::path& path) { return parse_pose_js(read_text(path), path.string()); }

}  // namespace clothbench::assets
