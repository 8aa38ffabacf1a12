// Scenario files: text to resolved scene.
#include "base/json_text.hpp"
#include "fuzz.hpp"
#include "scenario/load.hpp"

void clothbench::fuzz_scene(const std::uint8_t* data, std::size_t size) {
  reads_or_refuses([&] {
    const nlohmann::json j = parse_json(std::string(reinterpret_cast<const char*>(data), size), "scene.json");
    // The schema limits what a file may request. Loading is slow near the limits, so the fuzzer uses small values.
    const auto number = [&](const char* pointer, double otherwise) {
      const nlohmann::json::json_pointer at(pointer);
      return j.contains(at) && j[at].is_number() ? j[at].get<double>() : otherwise;
    };
    if (number("/cloth/grid/0", 2) * number("/cloth/grid/1", 2) > 1e4 ||
        number("/time/duration_s", 1) * number("/time/frame_rate_hz", 60) > 1e4)
      return;
    scene_from_json(j, "scene.json");
  });
}
