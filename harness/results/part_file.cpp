#include "results/part_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <utility>

#include "base/files.hpp"
#include "base/json_text.hpp"
#include "clothbench/error.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using Bytes = std::vector<std::uint8_t>;

static_assert(std::endian::native == std::endian::little, "series are written as memory holds them");

template <class T>
json packed(const std::vector<T>& values) {
  const auto* from = reinterpret_cast<const std::uint8_t*>(values.data());
  return json::binary(Bytes(from, from + values.size() * sizeof(T)));
}

template <class T>
void unpack(const json& j, std::vector<T>& out) {
  const Bytes& bytes = j.get_binary();
  if (bytes.size() % sizeof(T) != 0) throw Error("a series ends within a number");
  out.resize(bytes.size() / sizeof(T));
  if (!out.empty()) std::memcpy(out.data(), bytes.data(), bytes.size());
}

/// Calls `with(key, member)` for each header member that is stored unchanged. Header: RunHeader, const or not.
template <class Header, class With>
void each_member(Header& h, With with) {
  with("scene", h.scene);
  with("solver", h.solver);
  with("setting", h.setting);
  with("settings", h.settings);
  with("scenario_json", h.scenario_json);
  with("scenario_sha256", h.scenario_sha256);
  with("plan", h.plan);
  with("environment", h.environment);
  with("vertices", h.vertices);
  with("triangles", h.triangles);
}

void expect(bool holds, const char* what) {
  if (!holds) throw Error(what);
}

/// An integer, or a list of them. Throws Error unless each fits in T, because the library would cast any number.
template <class T>
void get_whole(const json& j, T& to) {
  bool fits = j.is_number_unsigned() && std::in_range<T>(j.get<std::uint64_t>());
  fits = fits || (j.is_number_integer() && !j.is_number_unsigned() && std::in_range<T>(j.get<std::int64_t>()));
  expect(fits, "expected a whole number in range");
  j.get_to(to);
}
template <class T>
void get_whole(const json& j, std::vector<T>& to) {
  expect(j.is_array(), "expected a list of whole numbers");
  for (const json& e : j) get_whole(e, to.emplace_back());
}
template <class T>
T whole(const json& j) {
  T to{};
  get_whole(j, to);
  return to;
}

TimedTrial trial_from_json(const json& j, std::size_t stages) {
  TimedTrial t;
  get_whole(j.at("index"), t.index);
  for (const TrialNumber& n : kTrialNumbers) j.at(n.name).get_to(t.*n.value);
  for (const TrialSeries& s : kTrialSeries) {
    unpack(j.at(s.name), t.*s.values);
    expect(s.optional || (t.*s.values).size() == t.frame_wall_s.size() * (s.by_stage ? stages : 1),
           "a trial's series differ in length");
  }
  return t;
}

void add_frame(const json& j, std::size_t vertices, AccuracyPass& pass) {
  const auto k = whole<std::size_t>(j.at("index"));
  if (k == 0) {
    pass.position.clear();
    pass = {.time_s = {}, .position = std::move(pass.position), .metrics = {}};  // keeps the memory
  }
  expect(k == pass.time_s.size(), "a frame is missing");
  std::vector<float> position;
  unpack(j.at("position"), position);
  expect(position.size() == vertices * 3, "expected one position for each vertex");
  pass.time_s.push_back(j.at("time_s"));
  pass.position.insert(pass.position.end(), position.begin(), position.end());
}

std::vector<MetricSeries> metrics_from_json(const json& j, std::size_t frames) {
  std::vector<MetricSeries> metrics;
  for (const json& m : j) {
    metrics.push_back({m.at("name"), m.at("units"), m.at("long_name"), {}});
    unpack(m.at("values"), metrics.back().values);
    expect(metrics.back().values.size() == frames, "a metric has a different number of frames");
  }
  return metrics;
}

std::vector<StoredGroup> groups_from_json(const json& j) {
  std::vector<StoredGroup> groups;
  for (const json& g : j) {
    groups.push_back({g.at("path"), g.at("attributes"), {}});
    for (const json& a : g.at("arrays")) {
      StoredArray& array = groups.back().arrays.emplace_back();
      array = {a.at("name"), a.at("units"), a.at("long_name"), a.at("dims"), {}, a.at("integer")};
      get_whole(a.at("shape"), array.shape);
      unpack(a.at("values"), array.values);
      std::size_t left = array.values.size();  // divide, because a product could overflow
      for (const std::uint64_t n : array.shape) {
        expect(n == 0 ? left == 0 : left % n == 0, "an array has another number of values than its shape");
        left = n == 0 ? 0 : left / n;
      }
      expect(array.values.empty() || left == 1, "an array has another number of values than its shape");
      expect(array.dims.size() == array.shape.size(), "an array's dimensions have no names");
    }
  }
  return groups;
}

void take(const std::string& kind, const json& body, RunRecord& r) {
  if (kind == "header") {
    RunHeader h = header_from_json(body);
    expect(r.accuracy.time_s.empty() || h.vertices == r.header.vertices, "its headers describe different cloths");
    expect(r.trials.empty() || h.stages.size() == r.header.stages.size(), "its headers differ in stages");
    r.header = std::move(h);
  }
  if (kind == "replay") r.replay = groups_from_json(body);
  if (kind == "frame") add_frame(body, r.header.vertices, r.accuracy);
  if (kind == "accuracy") r.accuracy.metrics = metrics_from_json(body, r.accuracy.time_s.size());
  if (kind == "outcome") outcome_from_json(body, r);
  if (kind != "trial") return;
  TimedTrial t = trial_from_json(body, r.header.stages.size());
  std::erase_if(r.trials, [&](const TimedTrial& other) { return other.index == t.index; });
  r.trials.push_back(std::move(t));
}

Bytes item(const char* kind, json body) {
  json j;
  j[kind] = std::move(body);
  return json::to_cbor(j);
}

/// End of the CBOR item at `at`; `bytes.size() + 1` if it is incomplete or has a form not written here: a tag, an
/// indefinite length or more than 64 levels, which the library would decode recursively.
std::size_t end_of_item(const std::string& bytes, std::size_t at) {
  const std::size_t size = bytes.size(), none = size + 1;
  std::vector<std::uint64_t> left = {1};  // items that remain, by depth
  while (!left.empty()) {
    if (left.back()-- == 0) {
      left.pop_back();
      continue;
    }
    if (at >= size) return none;
    const auto first = static_cast<std::uint8_t>(bytes[at++]);
    const unsigned major = first >> 5u, info = first & 31u;
    std::uint64_t n = info;
    if (info >= 24) {
      const std::size_t width = std::size_t{1} << (info - 24);
      if (info > 27 || width > size - at) return none;
      n = 0;
      for (std::size_t k = 0; k < width; ++k) n = n << 8u | static_cast<std::uint8_t>(bytes[at++]);
    }
    if (major == 6 || (major >= 2 && major <= 5 && n > size - at)) return none;
    if (major == 2 || major == 3) at += n;
    if (major == 4 || major == 5) left.push_back(major == 4 ? n : 2 * n);
    if (left.size() > 64) return none;
  }
  return at;
}

}  // namespace

json header_to_json(const RunHeader& h) {
  json j = {{"load_s", number_to_json(h.load_s)}, {"stages", json::array()}};
  each_member(h, [&](const char* key, const auto& value) { j[key] = value; });
  for (const StageRecord& s : h.stages)
    j["stages"].push_back({{"name", s.name}, {"serves", s.serves}, {"dispatches", s.dispatches}});
  return j;
}

RunHeader header_from_json(const json& j) {
  RunHeader h;
  each_member(h, [&](const char* key, auto& value) {
    using T = std::remove_reference_t<decltype(value)>;
    if constexpr (std::is_integral_v<T> || std::is_same_v<T, std::vector<std::uint32_t>>)
      get_whole(j.at(key), value);
    else
      j.at(key).get_to(value);
  });
  for (const json& s : j.at("stages"))
    h.stages.push_back({s.at("name"), s.at("serves"), whole<int>(s.at("dispatches"))});
  h.load_s = number_from_json(j.at("load_s"), "load_s");
  return h;
}

json outcome_to_json(const Outcome& o, const std::map<std::string, double>& summary) {
  return {{"status", o.status},
          {"class", o.klass},
          {"failed_frame", o.failed_frame},
          {"message", o.message},
          {"expect", o.expect},
          {"trajectory_sha256", o.trajectory_sha256},
          {"summary", numbers_to_json(summary)}};
}

void outcome_from_json(const json& j, RunRecord& r) {
  r.outcome = {j.at("status"),  j.at("class"),  whole<int>(j.at("failed_frame")),
               j.at("message"), j.at("expect"), j.at("trajectory_sha256")};
  r.summary = numbers_from_json(j.at("summary"));
}

json to_json(const TimedTrial& t) {
  json j = {{"index", t.index}};
  for (const TrialNumber& n : kTrialNumbers) j[n.name] = t.*n.value;
  for (const TrialSeries& s : kTrialSeries) j[s.name] = packed(t.*s.values);
  return j;
}

json frame_to_json(const AccuracyPass& a, std::size_t k) {
  const auto size = static_cast<std::ptrdiff_t>(a.position.size() / a.time_s.size());
  const auto first = a.position.begin() + static_cast<std::ptrdiff_t>(k) * size;
  return {{"index", k}, {"time_s", a.time_s[k]}, {"position", packed(std::vector<float>(first, first + size))}};
}

json to_json(const std::vector<MetricSeries>& metrics) {
  json out = json::array();
  for (const MetricSeries& m : metrics)
    out.push_back({{"name", m.name}, {"units", m.units}, {"long_name", m.long_name}, {"values", packed(m.values)}});
  return out;
}

json to_json(const std::vector<StoredGroup>& groups) {
  json out = json::array();
  for (const StoredGroup& g : groups) {
    out.push_back({{"path", g.path}, {"attributes", g.attributes}, {"arrays", json::array()}});
    for (const StoredArray& a : g.arrays)
      out.back()["arrays"].push_back({{"name", a.name},
                                      {"units", a.units},
                                      {"long_name", a.long_name},
                                      {"dims", a.dims},
                                      {"shape", a.shape},
                                      {"integer", a.integer},
                                      {"values", packed(a.values)}});
  }
  return out;
}

void create_part(const fs::path& path, const RunHeader& header) {
  const Bytes bytes = item("header", header_to_json(header));
  write_file_atomically(path, {bytes.begin(), bytes.end()});
}

void append_to_part(const fs::path& path, const char* kind, json body, bool sync) {
  const Bytes bytes = item(kind, std::move(body));
  const int file = open(path.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
  const off_t before = file < 0 ? 0 : lseek(file, 0, SEEK_END);
  bool written = file >= 0;
  for (std::size_t at = 0; written && at < bytes.size();) {
    const ssize_t n = write(file, bytes.data() + at, bytes.size() - at);
    if (n > 0) at += static_cast<std::size_t>(n);
    written = n > 0 || errno == EINTR;
  }
  written = written && (!sync || fsync(file) == 0);
  const int why = errno;
  // If this fails too, the reader ignores the incomplete item.
  const bool restored = written || file < 0 || ftruncate(file, before) == 0;
  if (file >= 0) close(file);
  if (!written)
    throw Error(fmt::format("{}: {} cannot be appended: {}{}", path.string(), kind, std::strerror(why),
                            restored ? "" : "; it ends with an incomplete item"),
                ExitCode::CheckFailed);
}

RunRecord read_part(const fs::path& path, std::uintmax_t* complete_B) {
  if (!fs::is_regular_file(path)) throw Error(path.string() + ": no such file");
  const std::string bytes = content_of(path);
  RunRecord r;
  std::size_t at = 0;
  r.accuracy.position.reserve(bytes.size() / sizeof(float));  // growth would copy large motions
  try {
    for (std::size_t end = end_of_item(bytes, 0); end <= bytes.size() && end > at; end = end_of_item(bytes, at)) {
      const json item = json::from_cbor(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                                        bytes.begin() + static_cast<std::ptrdiff_t>(end));
      if (!item.is_object() || item.size() != 1 || (at == 0 && !item.contains("header"))) break;
      take(item.begin().key(), item.front(), r);
      at = end;
    }
  } catch (const json::exception& e) {
    throw Error(path.string() + ": not a run: " + what_without_text(e));
  } catch (const Error& e) {
    throw Error(path.string() + ": " + e.what());
  }
  if (at == 0) throw Error(path.string() + ": not a run: expected a CBOR object \"header\" at its beginning");
  if (complete_B != nullptr) *complete_B = at;
  std::sort(r.trials.begin(), r.trials.end(), [](const auto& a, const auto& b) { return a.index < b.index; });
  return r;
}

}  // namespace clothbench
