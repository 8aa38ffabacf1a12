#pragma once
#include <Eigen/Geometry>
#include <bit>
#include <cstdint>
#include <cstring>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace clothbench::assets {

/// A value in a JSON document with its file and JSON pointer, so that every error message names both.
class JsonAt {
 public:
  /// The root value. `root` must outlive this object and all objects derived from it.
  JsonAt(const nlohmann::json& root, std::string source);

  const nlohmann::json& json() const { return *value_; }
  const std::string& pointer() const { return pointer_; }
  /// Throws Error "<file>: <pointer>: <message>".
  [[noreturn]] void fail(const std::string& message) const;

  JsonAt key(const std::string& name) const;                   ///< the key must exist
  std::optional<JsonAt> maybe(const std::string& name) const;  ///< this must be an object
  JsonAt item(std::size_t i) const;
  std::size_t size() const;  ///< this must be an array

  double number() const;  ///< finite
  double number_or(const std::string& name, double otherwise) const;
  std::string text() const;
  std::vector<std::uint8_t> bytes() const;  ///< of base64 (RFC 4648 section 4), padded, no line breaks
  /// The bytes as items that lie in memory as they do in the file.
  template <class Item>
  std::vector<Item> items() const {
    static_assert(std::is_trivially_copyable_v<Item> && std::endian::native == std::endian::little);
    const std::vector<std::uint8_t> from = bytes();
    if (from.size() % sizeof(Item) != 0)
      fail(std::to_string(from.size()) + " bytes; expected a multiple of " + std::to_string(sizeof(Item)));
    std::vector<Item> out(from.size() / sizeof(Item));
    if (!out.empty()) std::memcpy(out.data(), from.data(), from.size());
    return out;
  }
  bool boolean() const;
  Eigen::VectorXd numbers(std::size_t n) const;  ///< an array of exactly n finite numbers
  /// Fails if the object has any other key, naming the nearest known one.
  void only(const std::vector<std::string>& known) const;
  /// The string, which must be one of `known`; otherwise fails and suggests the nearest.
  std::string word(const std::vector<std::string>& known) const;

 private:
  JsonAt(const nlohmann::json& value, std::shared_ptr<const std::string> source, std::string pointer);
  const nlohmann::json* value_;
  std::shared_ptr<const std::string> source_;
  std::string pointer_;
};

/// RFC 4648 section 4, padded.
std::string encode_base64(const std::uint8_t* bytes, std::size_t count);

}  // namespace clothbench::assets
