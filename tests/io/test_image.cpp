// What is written to an image is read back; what is none is refused.
#include "rbvi/core/error.hpp"
#include "rbvi/io/image.hpp"

#include <gtest/gtest.h>

namespace rbvi::image_test {
namespace {

Bytes bytes_of(const std::string &image) {
  return std::as_bytes(std::span(image.data(), image.size()));
}

TEST(Image, KeepsValuesOfEachType) {
  ImageWriter writer;
  const Matrix matrix = Matrix::Random(3, 5);
  const Vector vector = Vector::Random(7);
  const std::vector<double> doubles{0.1, -0.0, 1e300};
  const std::vector<int> integers{1, -2, 3};
  const std::vector<std::string> texts{"", "a", "eight by", "longer than that"};
  writer.write("matrix", matrix);
  writer.write("vector", vector);
  writer.write("doubles", doubles);
  writer.write("integers", integers);
  writer.write("texts", texts);
  writer.write("no texts", std::vector<std::string>{});
  writer.write("nothing", Matrix(0, 4));
  writer.write("text", std::string("a text"));
  writer.write("double", 1.5);
  writer.write("integer", -7);
  EXPECT_THROW(writer.write("integer", 7), Error);
  const std::string image = writer.image(3);
  EXPECT_TRUE(is_image(bytes_of(image)));
  const ImageReader reader(bytes_of(image), "it", 3);
  EXPECT_EQ(reader.read<Matrix>("matrix"), matrix);
  EXPECT_EQ(reader.read<Vector>("vector"), vector);
  EXPECT_EQ(reader.read<std::vector<double>>("doubles"), doubles);
  EXPECT_EQ(reader.read<std::vector<int>>("integers"), integers);
  EXPECT_EQ(reader.read<std::vector<std::string>>("texts"), texts);
  EXPECT_TRUE(reader.read<std::vector<std::string>>("no texts").empty());
  EXPECT_EQ(reader.read<Matrix>("nothing").cols(), 4);
  EXPECT_EQ(reader.read<std::string>("text"), "a text");
  EXPECT_EQ(reader.read<double>("double"), 1.5);
  EXPECT_EQ(reader.read<int>("integer"), -7);
  EXPECT_TRUE(reader.has("text"));
  EXPECT_FALSE(reader.has("else"));
  EXPECT_THROW((void)reader.read<int>("else"), Error);
  EXPECT_THROW((void)reader.read<int>("double"), Error);
}

TEST(Image, RefusesWhatIsDamaged) {
  ImageWriter writer;
  writer.write("texts", std::vector<std::string>{"one", "two"});
  writer.write("matrix", Matrix(Matrix::Random(4, 4)));
  const std::string image = writer.image(1);
  EXPECT_THROW(ImageReader(bytes_of(image), "it", 2), Error);
  for (std::size_t length = 0; length < image.size(); ++length)
    EXPECT_THROW(ImageReader(bytes_of(image.substr(0, length)), "it", 1), Error) << length;
  EXPECT_THROW(ImageReader(bytes_of(image + std::string(8, '\0')), "it", 1), Error);
  for (std::size_t byte = 0; byte < image.size(); ++byte) {
    std::string other = image;
    other[byte] = static_cast<char>(other[byte] ^ 1);
    EXPECT_THROW(ImageReader(bytes_of(other), "it", 1), Error) << byte;
  }
}

} // namespace
} // namespace rbvi::image_test
