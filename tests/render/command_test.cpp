// `clothbench render` as users see it.
#include "command.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "base/json_text.hpp"
#include "sheets.hpp"

namespace clothbench::render {
namespace {

namespace fs = std::filesystem;

using testing_command::Answer;

Answer command(const std::string& arguments, const std::string& environment = "") {
  return testing_command::command(arguments, testing_command::Streams::Both, environment);
}

/// Two runs with positions.
class RenderCommand : public WithFolder {
 protected:
  void SetUp() override {
    const Answer a = command(
        "run contact/sphere validation/pendulum --solver ballistic --solver xpbd --trials 0 --set time.duration_s=0.1 "
        "--out " +
        runs());
    ASSERT_EQ(a.code, 0) << a.text;
  }
  std::string runs() const { return (dir_ / "runs").string(); }
  std::string out() const { return (dir_ / "out").string(); }
};

TEST_F(RenderCommand, WritesPicturesOfAFile) {
  const Answer a = command("--json render " + runs() +
                           "/sphere-drop__xpbd__default.h5 --frames 0:-1:2 --no-movie --size 320x240 -o " + out());
  ASSERT_EQ(a.code, 0) << a.text;
  const auto reported = nlohmann::json::parse(a.text);
  ASSERT_EQ(reported["pictures"].size(), 4u) << "frames 0, 2, 4, 6";
  for (const auto& p : reported["pictures"]) {
    const Picture picture = read_png(p.get<std::string>());
    EXPECT_EQ(picture.width, 320);
    EXPECT_EQ(picture.height, 240);
    int coloured = 0;
    for (std::size_t k = 0; k < picture.rgb.size(); k += 3)
      coloured += std::abs(picture.rgb[k] - picture.rgb[k + 2]) > 40 ? 1 : 0;
    EXPECT_GT(coloured, 500) << "the cloth";
  }
  EXPECT_TRUE(reported["movies"].empty());
}

TEST_F(RenderCommand, SaysThatFfmpegIsMissing) {
  const fs::path empty = dir_ / "empty";
  fs::create_directories(empty);
  const Answer a =
      command("render " + runs() + "/sphere-drop__xpbd__default.h5 --frames 0:1 --size 160x120 -o " + out(),
              "PATH=" + empty.string());
  EXPECT_EQ(a.code, 0) << a.text;
  EXPECT_NE(a.text.find("no movie: ffmpeg"), std::string::npos) << a.text;
}

TEST_F(RenderCommand, RefusesWhatItCannotDo) {
  const std::string file = runs() + "/sphere-drop__xpbd__default.h5";
  const fs::path text = dir_ / "text.h5";
  std::ofstream(text) << "no result file";
  const fs::path empty = dir_ / "nothing";
  fs::create_directories(empty);
  const std::vector<std::pair<std::string, std::string>> wrong = {{file + " --frames 99", "expected frames from 0 to"},
                                                                  {file + " --frames x", "expected a number"},
                                                                  {file + " --size 10", "WIDTHxHEIGHT"},
                                                                  {text.string(), "text.h5"},
                                                                  {runs() + "/none.h5", "none.h5"},
                                                                  {"paper/gravity", "expected a result file"},
                                                                  {empty.string(), "expected a result file"},
                                                                  {file + " --device 99", "device"}};
  for (const auto& [arguments, reported] : wrong) {
    const Answer a = command("render " + arguments + " -o " + out());
    EXPECT_TRUE(a.code == 2 || a.code == 3) << arguments << ": " << a.code << " " << a.text;
    EXPECT_NE(a.text.find(reported), std::string::npos) << arguments << ": " << a.text;
  }
}

TEST_F(RenderCommand, TimesFramesWithTheirPictures) {
  const std::string runs_with = (dir_ / "with").string();
  const Answer a =
      command("study table3 --quick --solver xpbd --trials 1 --with-rendering --eye 32x32 --out " + runs_with);
  ASSERT_EQ(a.code, 0) << a.text;
  ASSERT_EQ(command("report " + runs_with + " -o " + runs_with + "-report").code, 0);
  EXPECT_NE(clothbench::read_text(runs_with + "-report/report.md").find("wall, with rendering"), std::string::npos);
  EXPECT_EQ(command("study table3 --quick --eye 32x32").code, 2) << "an eye without rendering";
  EXPECT_EQ(command("study table3 --quick --with-rendering --eye big --out " + runs_with + "2").code, 2);
}

}  // namespace
}  // namespace clothbench::render
