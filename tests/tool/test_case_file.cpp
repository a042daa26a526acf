// Case files: what is read, and what is said of files that are none.
#include "rbvi/core/error.hpp"
#include "rbvi/tool/case_file.hpp"

#include <gtest/gtest.h>

namespace rbvi::case_file_test {
namespace {

std::string read(const std::string &text) {
  std::string all;
  for (const CaseSetting &entry : parse_options(text, "x.yaml"))
    all += std::to_string(entry.line) + ":" + entry.name + "=" + entry.value + ";";
  return all;
}

/// The message, or what was read.
std::string refusal(const std::string &text) {
  try {
    return "read " + read(text);
  } catch (const Error &error) {
    EXPECT_EQ(error.status(), Status::bad_input);
    const std::string message = error.what(), begin = "the case file x.yaml is malformed at line ";
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_TRUE(message.starts_with(begin)) << message;
    return message.substr(std::min(begin.size(), message.size()));
  }
}

TEST(CaseFile, OneOptionPerLine) {
  EXPECT_EQ(read(""), "");
  EXPECT_EQ(read("# nothing\n\n"), "");
  EXPECT_EQ(read("scene: patch\n\n# a comment\ntrain: grid:5 # behind\n"),
            "1:scene=patch;4:train=grid:5;");
  EXPECT_EQ(read("--- \nscene: patch\n...\n"), "2:scene=patch;");
  EXPECT_EQ(read("\xef\xbb\xbfscene: patch\r\nplan: yes\r\n"), "1:scene=patch;2:plan=yes;");
  EXPECT_EQ(read("  a: 1\n  b: 2\n"), "1:a=1;2:b=2;");
  EXPECT_EQ(read("{a: 1, b: 2}\n"), "1:a=1;1:b=2;");
}

TEST(CaseFile, ValuesAreTextAsItStands) {
  EXPECT_EQ(read("a: yes\nb: No\nc: true\nd: 1e-6\ne: 0x10\nf: 1_000\n"),
            "1:a=yes;2:b=No;3:c=true;4:d=1e-6;5:e=0x10;6:f=1_000;");
  EXPECT_EQ(read("radius: 0.7,1.3\ncenter: -0.1,0.1\n"), "1:radius=0.7,1.3;2:center=-0.1,0.1;");
  EXPECT_EQ(read("radius: [0.7, 1.3]\n"), "1:radius=0.7,1.3;");
  EXPECT_EQ(read("radius:\n  - 0.7\n  - 1.3\nmu: 1\n"), "1:radius=0.7,1.3;4:mu=1;");
  EXPECT_EQ(read("out: 'it''s #1'\nmesh: \"a b.msh\"\n"), "1:out=it's #1;2:mesh=a b.msh;");
  EXPECT_EQ(read("mesh:\nout: ~\n"), "1:mesh=;2:out=;");
  EXPECT_EQ(read("a: &bounds 0.1,0.2\nb: *bounds\n"), "1:a=0.1,0.2;2:b=0.1,0.2;");
  EXPECT_EQ(read("out: r\xc3\xa9sultats\n"), "1:out=r\xc3\xa9sultats;");
}

TEST(CaseFile, TextsMayBeFolded) {
  EXPECT_EQ(read("a: >\n  x: \"y\n  # z\nb: 1\n"), "1:a=x: \"y # z;4:b=1;");
  EXPECT_EQ(read("a: >- # two lines\n  x\n  y\n"), "1:a=x y;");
  EXPECT_EQ(read("a: |\n  x\n"), "1:a=x;");
}

TEST(CaseFile, MistakesHaveTheirLine) {
  const std::pair<std::string, std::string> mistakes[] = {
      {"a: 1\nb: 2\na: 3\n", "3: a is given again, after line 1"},
      {"membrane\n", "1: "},
      {"scene: x\n\nload -25\n", "3: "},
      {"scene: x\nload:-25\n", "2: "},
      {"- scene\n- train\n", "1: 'name: value' is expected"},
      {"a: 1\nb: [1, 2\n", "3: "},
      {"a: 1\nb: [[1]]\n", "2: the list of b"},
      {"a: []\n", "1: the list of a is empty"},
      {"a: 1\n\tb: 2\n", "2: it begins with a tab"},
      {"a: 1\npod: {tolerance: 1}\n", "2: options are not nested: write 'pod_tolerance: value'"},
      {"pod:\n  tolerance: 1\n", "1: options are not nested: write 'pod_tolerance: value'"},
      {"a: 1\n-radius: 2\n", "2: write radius without the dash"},
      {"a: 1\n--radius: 2\n", "2: write radius without the dash"},
      {"a: 1\n$$b: 2\n", "2: '$$b' is no name of an option"},
      {"<<: {a: 1}\n", "1: '<<' is no name of an option"},
      {"1: 2\n", "1: '1' is no name of an option"},
      {"? [a]\n: 1\n", "1: "},
      {"a: *b\n", "1: "},
      {"a: 1\nb: \"x\nc: 2\n", "2: a quote is not closed"},
      {"a: 1\n  b\nc: 2\n", ""},
      {"a: x\n  y\n", "2: it belongs to no name"},
      {"a: x >\n  y\n", "2: it belongs to no name"},
      {"a: |\n  x\n  y\n", "1: a value goes over several lines"},
      {"a: 1\n---\nb: 2\n", "3: a second document begins"},
      {"  a: 1\n b: 2\n", "2: "},
      {"a: 1\nb: \xff\xfe\n", "2: a byte is no UTF-8 text"},
      {"\xff\xfe"
       "a: 1\n",
       "1: a byte is no UTF-8 text"},
      {"a: 1\nb: \xc3(\n", "2: a byte is no UTF-8 text"},
      {std::string("a: 1\nb: \0\n", 10), "2: a byte is no UTF-8 text"},
      {std::string(5000, '['), "1: "},
      {"a: b: c\n", "1: "},
      {"a: @x\n", "1: "}};
  for (const auto &[text, part] : mistakes) {
    const std::string message = refusal(text);
    EXPECT_TRUE(message.starts_with(part) && !message.starts_with("read"))
        << text.substr(0, 60) << "\n  expected " << part << "\n  got " << message;
  }
}

TEST(CaseFile, WhatIsWrittenIsReadBack) {
  for (const std::string value : {"",
                                  "patch",
                                  "0.7,1.3",
                                  "-1,1",
                                  "random:64:1",
                                  "1e-6",
                                  "yes",
                                  "null",
                                  "~",
                                  "a b",
                                  "#1.msh",
                                  "it's",
                                  "a: b",
                                  "[a",
                                  "{",
                                  "*a",
                                  "&a",
                                  "!a",
                                  "- a",
                                  "-",
                                  "---",
                                  "a:",
                                  "x ",
                                  " x",
                                  "\"",
                                  "%a",
                                  "@a",
                                  "?",
                                  "r\xc3\xa9sultats",
                                  "=",
                                  ",",
                                  "|",
                                  ">"}) {
    const std::vector<CaseSetting> entries =
        parse_options("scene: x\n" + case_line("out", value), "x.yaml");
    ASSERT_EQ(entries.size(), 2U) << value;
    EXPECT_EQ(entries[1].value, value);
  }
}

TEST(CaseFile, IsReadByEveryRankOrRefusedByEveryRank) {
  EXPECT_THROW((void)read_case_text(MPI_COMM_WORLD, "/no/such.yaml"), Error);
  EXPECT_THROW((void)read_case_text(MPI_COMM_WORLD, "/"), Error);
  EXPECT_THROW((void)read_case_text(MPI_COMM_WORLD, "/dev/zero"), Error);
  EXPECT_EQ(read_case_text(MPI_COMM_WORLD, "/dev/null"), "");
}

} // namespace
} // namespace rbvi::case_file_test
