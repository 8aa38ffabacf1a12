#include "results/raw_file.hpp"

#include <array>
#include <bit>
#include <cstring>
#include <fstream>

#include "base/json_number.hpp"
#include "base/json_text.hpp"
#include "clothbench/error.hpp"
#include "results/store.hpp"

namespace clothbench {
namespace {

static_assert(std::endian::native == std::endian::little, "raw run files are written as memory lies");

constexpr char kMagic[9] = "CBRAW001";
constexpr std::size_t kMostHeader = 64u << 20;

using Bytes = std::vector<std::uint8_t>;

void put(std::string& out, const void* data, std::size_t size) { out.append(static_cast<const char*>(data), size); }
void put_u32(std::string& out, std::uint32_t v) { put(out, &v, sizeof v); }

template <class T>
void append(Bytes& out, const T* values, std::size_t count) {
  const std::size_t at = out.size();
  out.resize(at + count * sizeof(T));
  if (count > 0) std::memcpy(out.data() + at, values, count * sizeof(T));
}

/// Takes values off the front of a payload.
class Taker {
 public:
  explicit Taker(const Bytes& bytes) : bytes_(bytes) {}
  template <class T>
  void take(std::vector<T>& out, std::size_t count) {
    if (at_ + count * sizeof(T) > bytes_.size()) throw Error("a frame is shorter than its header states");
    const std::size_t old = out.size();
    out.resize(old + count);
    if (count > 0) std::memcpy(out.data() + old, bytes_.data() + at_, count * sizeof(T));
    at_ += count * sizeof(T);
  }

 private:
  const Bytes& bytes_;
  std::size_t at_ = 0;
};

std::string slurp(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw Error(path.string() + ": cannot be opened");
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Runs a reader of headers and payloads; whatever is wrong inside names the file.
template <class Fn>
auto naming(const std::filesystem::path& path, Fn fn) {
  try {
    return fn();
  } catch (const nlohmann::json::exception& e) {
    throw Error(path.string() + ": not a raw run file of this kind: " + what_without_text(e));
  } catch (const Error& e) {
    throw Error(path.string() + ": " + e.what());
  }
}

/// Calls `with(key, member)` for each member of a header that is stored as it is. Header: RunHeader, const or not.
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

}  // namespace

std::uint32_t crc32c(const std::uint8_t* data, std::size_t size, std::uint32_t seed) {
  static const std::array<std::uint32_t, 256> table = [] {
    std::array<std::uint32_t, 256> t{};
    for (std::uint32_t i = 0; i < 256; ++i) {
      std::uint32_t c = i;
      for (int k = 0; k < 8; ++k) c = (c & 1u) != 0 ? 0x82f63b78u ^ (c >> 1) : c >> 1;  // Castagnoli, reflected
      t[i] = c;
    }
    return t;
  }();
  std::uint32_t c = ~seed;
  for (std::size_t i = 0; i < size; ++i) c = table[(c ^ data[i]) & 255u] ^ (c >> 8);
  return ~c;
}

void write_raw(const std::filesystem::path& path, nlohmann::json header, const std::vector<Bytes>& payloads) {
  const std::size_t payload_B = payloads.empty() ? 0 : payloads.front().size();
  header["frame_B"] = payload_B + 8;
  const std::string text = header.dump();
  std::string out(kMagic, 8);
  put_u32(out, static_cast<std::uint32_t>(text.size()));
  out += text;
  put_u32(out, crc32c(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
  for (std::uint32_t k = 0; k < payloads.size(); ++k) {
    const std::size_t start = out.size();
    put_u32(out, k);
    put(out, payloads[k].data(), payloads[k].size());
    put_u32(out, crc32c(reinterpret_cast<const std::uint8_t*>(out.data()) + start, out.size() - start));
  }
  write_file_atomically(path, out);
}

RawFile read_raw(const std::filesystem::path& path) {
  const std::string all = slurp(path);
  const auto* data = reinterpret_cast<const std::uint8_t*>(all.data());
  const auto u32 = [&](std::size_t at) {
    std::uint32_t v = 0;
    std::memcpy(&v, data + at, 4);
    return v;
  };
  if (all.size() < 16 || std::memcmp(data, kMagic, 8) != 0)
    throw Error(path.string() + ": not a raw run file (it does not begin with CBRAW001)");
  const std::size_t length = u32(8);
  if (length > kMostHeader || all.size() < 16 + length)
    throw Error(path.string() + ": the file ends within its header");
  if (crc32c(data + 12, length) != u32(12 + length)) throw Error(path.string() + ": its header is damaged (CRC32C)");
  RawFile file;
  file.header = nlohmann::json::parse(all.substr(12, length), nullptr, false);
  if (!file.header.is_object() || !file.header.contains("frame_B") || !file.header["frame_B"].is_number_unsigned())
    throw Error(path.string() + ": its header has no frame_B");
  const auto frame_B = file.header["frame_B"].get<std::size_t>();
  if (frame_B < 8) throw Error(path.string() + ": frame_B: expected at least 8");
  std::size_t at = 16 + length;
  for (std::uint32_t k = 0; at < all.size(); ++k, at += frame_B) {
    const bool whole =
        frame_B <= all.size() - at && u32(at) == k && crc32c(data + at, frame_B - 4) == u32(at + frame_B - 4);
    if (!whole) {
      file.complete = false;
      break;
    }
    file.frames.emplace_back(data + at + 4, data + at + frame_B - 4);
  }
  return file;
}

nlohmann::json outcome_to_json(const Outcome& o, const std::map<std::string, double>& summary) {
  return {{"status", o.status},   {"class", o.klass},   {"failed_frame", o.failed_frame},
          {"message", o.message}, {"expect", o.expect}, {"summary", numbers_to_json(summary)}};
}

void outcome_from_json(const nlohmann::json& j, RunRecord& r) {
  r.outcome = {j.at("status"), j.at("class"), j.at("failed_frame"), j.at("message"), j.at("expect")};
  r.summary = numbers_from_json(j.at("summary"));
}

nlohmann::json header_to_json(const RunHeader& h) {
  nlohmann::json j = {{"load_s", number_to_json(h.load_s)}, {"stages", nlohmann::json::array()}};
  each_member(h, [&](const char* key, const auto& value) { j[key] = value; });
  for (const StageRecord& s : h.stages)
    j["stages"].push_back({{"name", s.name}, {"serves", s.serves}, {"dispatches", s.dispatches}, {"bytes", s.bytes}});
  return j;
}

RunHeader header_from_json(const nlohmann::json& j) {
  RunHeader h;
  each_member(h, [&](const char* key, auto& value) { j.at(key).get_to(value); });
  for (const auto& s : j.at("stages"))
    h.stages.push_back({s.at("name").get<std::string>(), s.at("serves").get<std::vector<std::string>>(),
                        s.at("dispatches").get<int>(), s.value("bytes", "")});
  h.load_s = number_from_json(j.at("load_s"), "load_s");
  return h;
}

RunHeader read_header(const std::filesystem::path& raw) { return header_from_json(read_raw(raw).header.at("run")); }

void write_trial_file(const std::filesystem::path& path, const TimedTrial& t, std::size_t stages) {
  std::vector<Bytes> frames;
  for (std::size_t f = 0; f < t.frame_wall_s.size(); ++f) {
    Bytes b;
    append(b, &t.frame_wall_s[f], 1);
    append(b, &t.frame_device_s[f], 1);
    for (const auto* series : {&t.stage_device_s, &t.stage_read_B, &t.stage_write_B})
      append(b, series->data() + f * stages, stages);
    frames.push_back(std::move(b));
  }
  nlohmann::json header = {{"kind", "trial"},
                           {"index", t.index},
                           {"stages", stages},
                           {"frames", frames.size()},
                           {"pipelined_wall_s", number_to_json(t.pipelined_wall_s)},
                           {"start_unix_s", number_to_json(t.start_unix_s)},
                           {"end_unix_s", number_to_json(t.end_unix_s)},
                           {"jobs", t.jobs}};
  if (!t.frame_rendered_s.empty()) header["frame_rendered_s"] = t.frame_rendered_s;
  if (!t.frame_cpu_s.empty()) header["frame_cpu_s"] = t.frame_cpu_s;
  write_raw(path, std::move(header), frames);
}

TimedTrial read_trial_file(const std::filesystem::path& path) {
  return naming(path, [&] {
    const RawFile file = read_raw(path);
    const auto stages = file.header.at("stages").get<std::size_t>();
    if (!file.complete || file.frames.size() != file.header.at("frames").get<std::size_t>())
      throw Error("damaged: frames are missing");
    TimedTrial t;
    t.index = file.header.at("index").get<int>();
    const auto number = [&](const char* key) { return number_from_json(file.header.at(key), key); };
    t.pipelined_wall_s = number("pipelined_wall_s");
    t.start_unix_s = number("start_unix_s");
    t.end_unix_s = number("end_unix_s");
    t.jobs = number("jobs");
    const auto list = [&](const char* key) { return file.header.value(key, std::vector<double>()); };
    t.frame_rendered_s = list("frame_rendered_s");
    t.frame_cpu_s = list("frame_cpu_s");
    for (const Bytes& b : file.frames) {
      Taker taker(b);
      taker.take(t.frame_wall_s, 1);
      taker.take(t.frame_device_s, 1);
      taker.take(t.stage_device_s, stages);
      taker.take(t.stage_read_B, stages);
      taker.take(t.stage_write_B, stages);
    }
    return t;
  });
}

void write_accuracy_file(const std::filesystem::path& path, const AccuracyPass& a, std::uint32_t vertices) {
  nlohmann::json names = nlohmann::json::array();
  for (const MetricSeries& m : a.metrics)
    names.push_back({{"name", m.name}, {"units", m.units}, {"long_name", m.long_name}});
  std::vector<Bytes> frames;
  for (std::size_t f = 0; f < a.time_s.size(); ++f) {
    Bytes b;
    append(b, &a.time_s[f], 1);
    for (const MetricSeries& m : a.metrics) append(b, &m.values[f], 1);
    append(b, a.position.data() + f * 3 * vertices, 3 * std::size_t{vertices});
    frames.push_back(std::move(b));
  }
  write_raw(path, {{"kind", "accuracy"}, {"metrics", names}, {"vertices", vertices}, {"frames", frames.size()}},
            frames);
}

AccuracyPass read_accuracy_file(const std::filesystem::path& path) {
  return naming(path, [&] {
    const RawFile file = read_raw(path);
    if (!file.complete || file.frames.size() != file.header.at("frames").get<std::size_t>())
      throw Error("damaged: frames are missing");
    const auto vertices = file.header.at("vertices").get<std::size_t>();
    AccuracyPass a;
    for (const auto& m : file.header.at("metrics"))
      a.metrics.push_back({m.at("name").get<std::string>(),
                           m.at("units").get<std::string>(),
                           m.at("long_name").get<std::string>(),
                           {}});
    for (const Bytes& b : file.frames) {
      Taker taker(b);
      taker.take(a.time_s, 1);
      for (MetricSeries& m : a.metrics) taker.take(m.values, 1);
      taker.take(a.position, 3 * vertices);
    }
    return a;
  });
}

/// One frame: the values of all arrays one after another, f64. What they are stands in the header.
void write_replay_file(const std::filesystem::path& path, const std::vector<StoredGroup>& groups) {
  nlohmann::json described = nlohmann::json::array();
  Bytes all;
  for (const StoredGroup& g : groups) {
    nlohmann::json arrays = nlohmann::json::array();
    for (const StoredArray& a : g.arrays) {
      arrays.push_back({{"name", a.name},
                        {"units", a.units},
                        {"long_name", a.long_name},
                        {"dims", a.dims},
                        {"shape", a.shape},
                        {"integer", a.integer},
                        {"count", a.values.size()}});
      append(all, a.values.data(), a.values.size());
    }
    described.push_back({{"path", g.path}, {"attributes", g.attributes}, {"arrays", arrays}});
  }
  write_raw(path, {{"kind", "replay"}, {"groups", described}}, {all});
}

std::vector<StoredGroup> read_replay_file(const std::filesystem::path& path) {
  return naming(path, [&] {
    const RawFile file = read_raw(path);
    if (!file.complete || file.frames.size() != 1) throw Error("damaged: a part is missing");
    Taker taker(file.frames[0]);
    std::vector<StoredGroup> groups;
    for (const auto& g : file.header.at("groups")) {
      StoredGroup& group = groups.emplace_back();
      group.path = g.at("path").get<std::string>();
      group.attributes = g.at("attributes");
      for (const auto& a : g.at("arrays")) {
        StoredArray& array = group.arrays.emplace_back();
        array = {a.at("name"), a.at("units"), a.at("long_name"), a.at("dims"), a.at("shape"), a.at("integer"), {}};
        taker.take(array.values, a.at("count").get<std::size_t>());
      }
    }
    return groups;
  });
}

}  // namespace clothbench
