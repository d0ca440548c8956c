// What the server answers to the page.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <thread>

#include "holotrace/io/picture/image_file.h"
#include "holotrace/viewer/answers.h"
#include "holotrace/viewer/session.h"
#include "viewer/holograms.h"

namespace holotrace::test {
namespace {

using Json = nlohmann::json;

class AnswersOf : public ::testing::Test {
 protected:
  HttpAnswer ask(const std::string& path, const std::string& query = "", const std::string& method = "GET") {
    return answers({method, "/secret/" + path, query, {{"host", "127.0.0.1:80"}}});
  }
  Session session{{folder_of({random_hologram(532e-9, 0)})}};
  Answers answers{session, {"secret", "127.0.0.1", 80}};
};

TEST_F(AnswersOf, ThePage) {
  EXPECT_EQ(ask("").type, "text/html; charset=utf-8");
  EXPECT_EQ(ask("main.js").type, "text/javascript; charset=utf-8");
  EXPECT_EQ(ask("style.css").status, 200);
  EXPECT_EQ(ask("").body.find("http://"), std::string::npos);  // nothing from elsewhere
}

TEST_F(AnswersOf, FramesOfThePageAlone) {
  EXPECT_FALSE(ask("").may_be_framed);
  Answers embedded{session, {"secret", "127.0.0.1", 80, true}};
  const auto may_be_framed = [&](const std::string& path) {
    return embedded({"GET", path, "", {{"host", "127.0.0.1:80"}}}).may_be_framed;
  };
  EXPECT_TRUE(may_be_framed("/secret/"));
  EXPECT_FALSE(may_be_framed("/other/"));
  EXPECT_FALSE(may_be_framed("/secret/session"));
}

TEST_F(AnswersOf, NoOtherFiles) {
  for (const char* path :
       {"../hologram.png", "..%2fhologram.png", "%2e%2e/hologram.png", "./main.js", "/main.js", "main.js/", "..",
        "hologram.png", "/etc/passwd", "main.js%00", "....//hologram.png", "..\\hologram.png"})
    EXPECT_EQ(ask(path).status, 404) << path;
  EXPECT_EQ(ask("session", "", "POST").status, 405);
  EXPECT_EQ(answers({"GET", "/other/", "", {{"host", "127.0.0.1:80"}}}).status, 403);
}

TEST_F(AnswersOf, APictureWithItsFacts) {
  const HttpAnswer answer = ask("view", "distance=20+mm");
  ASSERT_EQ(answer.status, 200);
  const auto byte = [&](size_t i) { return size_t(static_cast<unsigned char>(answer.body[i])); };
  const size_t length = byte(0) + 256 * byte(1) + 65536 * byte(2);
  const Json facts = Json::parse(answer.body.substr(4, length));
  EXPECT_EQ(facts["columns"], 64);
  EXPECT_EQ(facts["rows"], 48);
  const TakenView view = *session.view(session.state_of({{"distance", "20 mm"}}));
  const std::vector<uint8_t> codes = srgb_codes(view.image, view.white);
  EXPECT_EQ(answer.body.substr(4 + length), std::string(codes.begin(), codes.end()));
}

TEST_F(AnswersOf, Films) {
  const std::string range = "distance=20+mm&sweep-from=20+mm&sweep-to=22+mm";
  const HttpAnswer gif = ask("film.gif", range + "&sweep=focus");
  EXPECT_EQ(gif.status, 200);
  EXPECT_EQ(gif.type, "image/gif");
  EXPECT_EQ(gif.body.substr(0, 6), "GIF89a");
  const auto error = [&](const std::string& path, const std::string& query) {
    const HttpAnswer answer = ask(path, query);
    EXPECT_EQ(answer.status, 400) << path << query;
    return Json::parse(answer.body)["error"].get<std::string>();
  };
  EXPECT_EQ(error("film.png", range + "&sweep=focus"), "expected a film .gif, .webp, .mp4 or .webm, got .png");
  EXPECT_EQ(error("film.gif", range), "expected focus or parallax for \"sweep\"");
  EXPECT_NE(error("film.gif", "sweep=focus&sweep-from=1&sweep-to=2+mm").find("expected a length with its unit"),
            std::string::npos);
  EXPECT_NE(error("film.gif", range + "&sweep=parallax").find("expected a pupil above 0 m"), std::string::npos);
}

TEST_F(AnswersOf, ErrorsAsSentences) {
  const HttpAnswer answer = ask("view", "pupil=4");
  EXPECT_EQ(answer.status, 400);
  EXPECT_EQ(Json::parse(answer.body)["error"],
            "pupil: expected a length with its unit, such as \"3 mm\", got \"4\" without a unit");
  EXPECT_EQ(ask("view", "a=%").status, 400);
  EXPECT_EQ(ask("panel", "item=0&as=other").status, 400);
  EXPECT_EQ(ask("panel", "item=99999999999999999999&as=level").status, 400);
  EXPECT_EQ(ask("values", "column=0&row=0&columns=1").status, 400);
  EXPECT_EQ(ask("reference").status, 404);
}

TEST_F(AnswersOf, OnlyTheNewestRequestOfAPage) {
  EXPECT_EQ(ask("view", "page=a&number=2").status, 200);
  EXPECT_EQ(ask("view", "page=a&number=1").status, 204);
  EXPECT_EQ(ask("view", "page=b&number=1").status, 200);
}

// While a picture of several holograms is at work, the number of a newer request of the same page stops it; another
// page's does not.
TEST(Answers, ANewerRequestStopsTheOneAtWork) {
  std::vector<Hologram> holograms;
  for (uint32_t frame = 0; frame < 12; ++frame) holograms.push_back(random_hologram(532e-9, frame));
  Session session({folder_of(holograms)});
  Answers answers(session, {"t", "127.0.0.1", 80});
  const auto ask = [&](const std::string& query) {
    return answers({"GET", "/t/view", query, {{"host", "127.0.0.1"}}}).status;
  };
  int outdated = 0;
  for (int64_t number = 1; number < 60; number += 2) {  // each time two requests at once
    const std::string settings = "&distance=" + std::to_string(number) + "+mm";
    int status = 0, other = 0;
    std::thread old([&] { status = ask("page=a&number=" + std::to_string(number) + settings); });
    std::thread beside([&] { other = ask("page=b&number=" + std::to_string(number) + settings); });
    EXPECT_EQ(ask("page=a&number=" + std::to_string(number + 1) + settings), 200);
    old.join();
    beside.join();
    EXPECT_TRUE(status == 200 || status == 204) << status;
    EXPECT_EQ(other, 200);
    outdated += status == 204;
  }
  EXPECT_GT(outdated, 0);  // it is nearly always outdated when its turn comes
}

}  // namespace
}  // namespace holotrace::test
