// The page of a report: motions are packed, thinned and described correctly, and data cannot break out of the page.
#include <gtest/gtest.h>
#include <unistd.h>
#include <zlib.h>

#include <cmath>
#include <set>

#include "fake_runs.hpp"
#include "report/web/page.hpp"
#include "results/store.hpp"
#include "with_folder.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

/// A sheet of columns x rows that waves and drifts.
Replay waving(std::size_t frames, std::size_t columns, std::size_t rows) {
  Replay r;
  for (std::size_t f = 0; f < frames; ++f) {
    r.frames.push_back(3 * f);
    r.time_s.push_back(0.04 * static_cast<double>(f));
    for (std::size_t j = 0; j < rows; ++j)
      for (std::size_t i = 0; i < columns; ++i) {
        const double t = 0.04 * static_cast<double>(f), u = 0.1 * static_cast<double>(i),
                     v = 0.1 * static_cast<double>(j);
        for (const double x : {u - 7.3 * t, std::sin(3 * u + 5 * t) * 0.2 + 4, v + 0.5 * 9.81 * t * t})
          r.position.push_back(static_cast<float>(x));
      }
  }
  return r;
}

TEST(PackedMotion, EndsWhereTheClothIsNoMore) {
  Replay r = waving(6, 4, 4);
  r.position[3 * (4 * 16 + 2)] = std::nanf("");
  const PackedMotion nan = pack_motion(r);
  EXPECT_EQ(nan.frames, (std::vector<std::size_t>{0, 3, 6, 9}));
  EXPECT_EQ(nan.cut_at, 12);
  r.position[3 * (2 * 16 + 2)] = 1e7f;
  EXPECT_EQ(pack_motion(r).cut_at, 6) << "flew apart";
  r.position[0] = std::numeric_limits<float>::infinity();
  EXPECT_TRUE(pack_motion(r).frames.empty());
}

class WebFiles : public WithFolder {
 protected:
  void SetUp() override {
    StudyManifest manifest{
        "table3", "2026-01-01T00:00:00Z", "clothbench study </script><b>table3", nlohmann::json::object(), {}};
    fs::create_directories(dir_ / "run");
    for (const int n : {9, 17})
      for (const char* solver : {"xpbd", "paper"}) write_run(fake_run(solver, n, "single", 0.002 * n), n, manifest);
    write_manifest(dir_ / "run", manifest);
  }

  void write_run(RunRecord c, int n, StudyManifest& manifest) const {
    const Replay motion = waving(90, static_cast<std::size_t>(n), static_cast<std::size_t>(n));
    c.header.vertices = static_cast<std::uint32_t>(n * n);
    c.header.triangles = {0, 1, 2};
    c.accuracy.time_s = motion.time_s;
    c.accuracy.position = motion.position;
    c.outcome = {"timed_out", "F3", 80, "too slow </script><!-- ü"};
    RunWriter writer(dir_ / "run", c.header);
    writer.write_accuracy(c.accuracy);
    writer.write_replay({{"colliders", {{"count", 1}, {"frame_rate_hz", 72.0}}, {}},
                         {"colliders/0",
                          {{"shape", "mesh"}, {"name", "ü"}, {"closed", 1}},
                          {{"position_m", "m", "", {"vertex", "xyz"}, {3, 3}, false, {0, 0, 0, 1, 0, 0, 0, 1, 0.5}},
                           {"triangles", "1", "", {"triangle", "corner"}, {1, 3}, true, {0, 1, 2}}}}});
    writer.finish(c.outcome, c.summary);
    manifest.runs.push_back(run_name(c.header));
  }
};

TEST_F(WebFiles, MotionsFillTheBudgetAndThePageSaysHowManyAreLeftOut) {
  const RunTable runs(collect({dir_ / "run"}));
  const Motions all = motions_of(runs);
  ASSERT_EQ(all.document["runs"].size(), 4u);
  EXPECT_EQ(all.document["colliders"].size(), 1u) << "the same in every run: once";
  EXPECT_EQ(all.blobs.size(), 4u + 2);
  EXPECT_EQ(all.document["runs"][0]["frames"].size(), 90u);
  EXPECT_EQ(all.document["left_out"], 0);
  std::size_t size = 0, packed = 0;
  for (const std::string& b : all.blobs) size += b.size();
  const Motions few = motions_of(runs, size / 2);
  for (const std::string& b : few.blobs) packed += b.size();
  EXPECT_LE(packed, size / 2);
  EXPECT_EQ(few.document["runs"].size() + few.document["left_out"].get<std::size_t>(), 4u);
  EXPECT_GT(few.document["runs"].size(), 0u);
  EXPECT_TRUE(motions_of(runs, 10).document["runs"].empty());
}

TEST_F(WebFiles, DataNeverBreaksOutOfItsElement) {
  const std::vector<RunRecord> runs = collect({dir_ / "run"});
  Page page;
  page.heading.title = "Runs of </script>";
  const RunTable table(runs);
  for (const View& v : views())
    if (v.title == "Runs that failed") page.sections.push_back({"failed", "Failed", tables_of(v, table)});
  const nlohmann::json document = page_document(table, page);
  const Motions motions{motions_of(table).document, {"QUJD"}};
  const std::string marks =
      "<!--clothbench:title--><!--clothbench:head--><!--clothbench:data--><!--clothbench:motions-->";
  const std::string html = page_html("<html>" + marks + "<script>code</script></html>", page, document, motions);
  std::size_t ends = 0;
  for (std::size_t at = 0; (at = html.find("</script", at)) != std::string::npos; ++at) ++ends;
  EXPECT_EQ(ends, 4u) << "data, motions, one blob, the code";
  EXPECT_EQ(html.find("<!--"), html.find("<!--clothbench:figure-->"));
  EXPECT_EQ(document["studies"].at(0)["command"], "clothbench study </script><b>table3");
  for (const auto& r : document["runs"])
    if (!r.value("published", false)) EXPECT_EQ(r.at("study"), 0) << "each run names its study";
  EXPECT_NE(document["runs"][0]["message"].get<std::string>().find("<!-- ü"), std::string::npos);
}

TEST_F(WebFiles, WithoutATemplateNoOlderPageStays) {
  const std::vector<RunRecord> runs = collect({dir_ / "run"});
  EXPECT_EQ(
      write_page(
          dir_, RunTable(runs), {},
          {"<html><!--clothbench:title--><!--clothbench:head--><!--clothbench:data--><!--clothbench:motions--></html>",
           ""}),
      "");
  EXPECT_GT(fs::file_size(dir_ / "index.html"), 1000u);
  EXPECT_EQ(write_page(dir_, RunTable(runs), {}, {"", "there was no Node when this was built"}),
            "The interactive page was left out: there was no Node when this was built.");
  EXPECT_FALSE(fs::exists(dir_ / "index.html"));
}

}  // namespace
}  // namespace clothbench
