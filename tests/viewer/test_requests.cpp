// The queries of the page: what they set, and what they may not.

#include <gtest/gtest.h>

#include <cstdlib>

#include "holotrace/viewer/requests.h"
#include "support/temporary.h"

namespace holotrace::test {
namespace {

TEST(Requests, DecodeKeysAndValues) {
  const Query query = parse_query("distance=300+mm&eye=0%200+250%20mm&draft=1&empty=");
  EXPECT_EQ(query, (Query{{"distance", "300 mm"}, {"draft", "1"}, {"empty", ""}, {"eye", "0 0 250 mm"}}));
}

TEST(Requests, RefuseBadEncoding) {
  const std::string expected = "expected two hexadecimal digits after % in the request";
  for (const char* text : {"a=%", "a=%2", "a=%zz", "a=%00", "%=1"})
    EXPECT_EQ(error_of([&] { parse_query(text); }), expected) << text;
  EXPECT_EQ(error_of([] { parse_query("a=1&a=2"); }), "expected each key once in the request, got \"a\" twice");
  EXPECT_EQ(error_of([] { parse_query(std::string(4097, 'a')); }),
            "expected a request of at most 4096 bytes, got 4097");
  EXPECT_NO_THROW(parse_query(std::string(4096, 'a')));
}

TEST(Requests, SetTheFlagsOfShow) {
  const ViewState state = view_state({{"distance", "250 mm"},
                                      {"pupil", "4 mm"},
                                      {"eye", "1 -2 200 mm"},
                                      {"subpixels", "3"},
                                      {"effects", "gaps,flicker"},
                                      {"items", "2,0"},
                                      {"draft", "1"},
                                      {"sampling", "point"}},
                                     {}, 3);
  EXPECT_EQ(state.camera.distances, std::vector<double>{0.25});
  EXPECT_EQ(state.camera.pupil, 0.004);
  EXPECT_EQ(state.camera.eye.y, -0.002);
  EXPECT_EQ(state.show.subpixels, 3);
  EXPECT_EQ(state.show.effects, (std::vector<std::string>{"gaps", "flicker"}));
  EXPECT_EQ(state.camera.sampling, PixelSampling::point);
  EXPECT_EQ(state.shown, (std::vector<size_t>{0, 2}));
  EXPECT_TRUE(state.is_draft);
}

TEST(Requests, SetValuesOfALiveScene) {
  const ViewState state = view_state({{"set.object.1.position", "0 0 -1 mm"}, {"set.time", "2 s"}}, {}, 1);
  EXPECT_EQ(state.edits, (std::vector<SceneEdit>{{"object.1.position", "0 0 -1 mm"}, {"time", "2 s"}}));
}

TEST(Requests, KeepDefaultsOfWhatIsLeftOut) {
  ViewState defaults;
  defaults.camera.binning = 2;
  defaults.camera.distances = {0.1};
  const ViewState state = view_state({{"exposure", "2"}}, defaults, 1);
  EXPECT_EQ(state.camera.binning, 2);
  EXPECT_EQ(state.camera.distances, std::vector<double>{0.1});
  EXPECT_EQ(state.camera.exposure, 2);
}

TEST(Requests, NameWhatIsWrong) {
  const auto error = [](const Query& query, size_t items = 2) {
    return error_of([&] { view_state(query, {}, items); });
  };
  EXPECT_EQ(error({{"pupill", "4 mm"}}), "unknown key \"pupill\"; did you mean \"pupil\"?");
  EXPECT_EQ(error({{"pupil", "4"}}),
            "pupil: expected a length with its unit, such as \"3 mm\", got \"4\" without a unit");
  EXPECT_EQ(error({{"pupil", "-1 mm"}}), "pupil: expected a length of 0 m or more, got -1 mm");
  EXPECT_EQ(error({{"distance", "1 2 mm"}}), "expected one distance, got 2");
  EXPECT_EQ(error({{"subpixels", "6"}}), "expected at most 5 subpixels here, got 6; use holotrace show");
  EXPECT_EQ(error({{"subpixels", "5"}}), "no error");
  EXPECT_EQ(error({{"illumination-states", "257"}}),
            "expected at most 256 illumination states here, got 257; use holotrace show");
  EXPECT_EQ(error({{"items", "2"}}), "expected numbers of holograms from 0 to 1 in \"items\", got \"2\"");
  EXPECT_EQ(error({{"items", "0,0"}}), "expected each hologram once in \"items\", got 0 twice");
  EXPECT_EQ(error({{"items", "-1"}}), "expected numbers of holograms from 0 to 1 in \"items\", got \"-1\"");
  EXPECT_EQ(error({{"items", "0"}}, 0), "expected no \"items\", because there is no hologram here yet");
  EXPECT_EQ(error({{"draft", "3"}}), "expected 1 or 2 for \"draft\", got \"3\"");
  EXPECT_NE(error({{"sweep", "focus"}}).find("unknown key \"sweep\""), std::string::npos);
}

TEST(Requests, BecomeArgumentsOfShow) {
  EXPECT_EQ(show_arguments({{"draft", "1"}, {"eye", "0 0 250 mm"}, {"focal-length", "17 mm"}, {"items", "0"}}),
            (std::vector<std::string>{"--eye", "0 0 250 mm", "--focal-length", "17 mm"}));
  EXPECT_EQ(show_arguments({{"image", "real"}, {"wavelength", "532 nm"}}),
            (std::vector<std::string>{"--image", "real", "--wavelength", "532 nm"}));
}

TEST(Requests, QuoteWordsForAShell) {
  EXPECT_EQ(shell_word("a/b-c_1.png"), "a/b-c_1.png");
  EXPECT_EQ(shell_word(""), "''");
  const std::string nasty = "it's $(touch x); `y` \"z\"\n\\";
  const std::string path = temporary("echo");  // the shell itself gives the word back
  ASSERT_EQ(std::system(("printf %s " + shell_word(nasty) + " > " + path).c_str()), 0);
  std::ifstream in(path);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}), nasty);
}

}  // namespace
}  // namespace holotrace::test
