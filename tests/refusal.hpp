#pragma once
#include <gtest/gtest.h>

#include <cctype>
#include <optional>
#include <string>

#include "clothbench/error.hpp"

namespace clothbench {

/// Makes a test name from the words of a table row. Without a name GoogleTest prints the row's addresses.
inline std::string test_name(const std::string& words) {
  std::string out;
  for (char c : words) out += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  return out;
}

/// The message of the Error that `call` throws; empty if it throws none. The Error must have the exit code `code`, if
/// that is given.
template <class Call>
std::string refusal(Call call, std::optional<ExitCode> code = {}) {
  try {
    call();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), code.value_or(e.code())) << e.what();
    return e.what();
  }
  return "";
}

/// EXPECT_PRED2(mentions, text, part) prints both if it fails.
inline bool mentions(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// The text with the first `from` replaced, which must be in it.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

}  // namespace clothbench
