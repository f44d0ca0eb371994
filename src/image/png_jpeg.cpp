// The kinds of file that most textures are. OpenImageIO reads them by the same libraries, but takes 0.2 s to start.
#include "image/png_jpeg.h"

#include <jpeglib.h>
#include <png.h>

#include <csetjmp>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <memory>
#include <new>
#include <vector>

#include "core/error.h"

namespace render2mpeg::image {
namespace {

/// Room for pixels, which the image keeps. Throws core::Error.
std::shared_ptr<std::vector<Codes>> room_for(StoredImage& image, const std::string& name) try {
    auto room = std::make_shared<std::vector<Codes>>(image.pixels());
    image.codes = *room;
    image.memory = room;
    return room;
} catch (const std::bad_alloc&) {
    throw core::Error("reading", name, "not enough memory for its pixels");
}

/// libpng's simplified interface on a file in memory.
class PngFile {
  public:
    PngFile(std::span<const std::byte> bytes, const std::string& name) : name_(name) {
        image_.version = PNG_IMAGE_VERSION;
        check(png_image_begin_read_from_memory(&image_, bytes.data(), bytes.size()));
    }
    ~PngFile() { png_image_free(&image_); }
    PngFile(const PngFile&) = delete;
    PngFile& operator=(const PngFile&) = delete;

    /// 16-bit samples are what it calls linear.
    bool is_of_bytes() const { return (image_.format & PNG_FORMAT_FLAG_LINEAR) == 0; }
    bool has_alpha() const { return (image_.format & PNG_FORMAT_FLAG_ALPHA) != 0; }
    int width() const { return static_cast<int>(image_.width); }
    int height() const { return static_cast<int>(image_.height); }

    void read(std::vector<Codes>& pixels) {
        image_.format = PNG_FORMAT_RGBA;
        check(png_image_finish_read(&image_, nullptr, pixels.data(), 0, nullptr));
    }

  private:
    void check(int done) const {
        if (done == 0 || PNG_IMAGE_FAILED(image_)) throw core::Error("reading", name_, image_.message);
    }

    png_image image_{};
    const std::string& name_;
};

/// Pixels per unit along x over those along y [PNG, 11.3.5.3: pHYs]; 1 where the file does not say.
float pixel_aspect_of(std::span<const std::byte> png) {
    constexpr std::size_t first_chunk = 8, around = 12;  // signature; length, type and check sum of a chunk
    const auto number = [&](std::size_t at) {
        std::uint32_t value = 0;
        for (std::size_t i = 0; i < 4; ++i) value = value << 8 | std::to_integer<std::uint32_t>(png[at + i]);
        return value;
    };
    for (std::size_t at = first_chunk; at + around <= png.size(); at += around + number(at)) {
        if (std::memcmp(&png[at + 4], "pHYs", 4) != 0) continue;
        const auto x = static_cast<float>(number(at + 8)), y = static_cast<float>(number(at + 12));
        return x > 0 && y > 0 ? y / x : 1.0f;
    }
    return 1;
}

std::optional<StoredImage> decode_png(std::span<const std::byte> bytes, const std::string& name) {
    PngFile file(bytes, name);
    if (!file.is_of_bytes()) return std::nullopt;
    StoredImage image;
    image.width = file.width();
    image.height = file.height();
    image.has_alpha = file.has_alpha();
    image.pixel_aspect = pixel_aspect_of(bytes);
    file.read(*room_for(image, name));
    return image;
}

/// libjpeg on a file in memory. Its errors jump, past nothing that has a destructor.
class JpegFile {
  public:
    JpegFile(std::span<const std::byte> bytes, const std::string& name) : name_(name) {
        file_.err = jpeg_std_error(&errors_.base);
        errors_.base.error_exit = [](j_common_ptr file) {
            (*file->err->format_message)(file, errors_of(file).message);
            std::longjmp(errors_of(file).place, 1);
        };
        errors_.base.output_message = [](j_common_ptr) {};
        if (!begin(bytes)) refuse();
    }
    ~JpegFile() { jpeg_destroy_decompress(&file_); }
    JpegFile(const JpegFile&) = delete;
    JpegFile& operator=(const JpegFile&) = delete;

    bool is_of_light() const {
        return file_.data_precision == 8 && (file_.jpeg_color_space == JCS_GRAYSCALE ||
                                             file_.jpeg_color_space == JCS_YCbCr || file_.jpeg_color_space == JCS_RGB);
    }
    int width() const { return static_cast<int>(file_.image_width); }
    int height() const { return static_cast<int>(file_.image_height); }

    void read(std::vector<Codes>& pixels) {
        if (!read_rows(reinterpret_cast<unsigned char*>(pixels.data()))) refuse();
    }

  private:
    struct Errors {
        jpeg_error_mgr base;
        std::jmp_buf place;
        char message[JMSG_LENGTH_MAX];
    };
    static Errors& errors_of(j_common_ptr file) { return *reinterpret_cast<Errors*>(file->err); }

    [[noreturn]] void refuse() const { throw core::Error("reading", name_, errors_.message); }

    bool begin(std::span<const std::byte> bytes) {
        if (setjmp(errors_.place) != 0) {
            jpeg_destroy_decompress(&file_);
            return false;
        }
        jpeg_create_decompress(&file_);
        jpeg_mem_src(&file_, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
        jpeg_read_header(&file_, TRUE);
        return true;
    }

    bool read_rows(unsigned char* to) {
        if (setjmp(errors_.place) != 0) return false;
        file_.out_color_space = JCS_EXT_RGBA;
        jpeg_start_decompress(&file_);
        while (file_.output_scanline < file_.output_height) {
            unsigned char* row = to + std::size_t{4} * file_.output_scanline * file_.output_width;
            jpeg_read_scanlines(&file_, &row, 1);
        }
        jpeg_finish_decompress(&file_);
        return true;
    }

    jpeg_decompress_struct file_{};
    Errors errors_{};
    const std::string& name_;
};

std::optional<StoredImage> decode_jpeg(std::span<const std::byte> bytes, const std::string& name) {
    JpegFile file(bytes, name);
    if (!file.is_of_light()) return std::nullopt;
    StoredImage image;
    image.width = file.width();
    image.height = file.height();
    file.read(*room_for(image, name));
    return image;
}

}  // namespace

std::optional<ImageHeader> header_of_png_or_jpeg(std::span<const std::byte> bytes, Format format,
                                                 const std::string& name) {
    std::optional<ImageHeader> header;
    if (format == Format::png)
        if (const PngFile file(bytes, name); file.is_of_bytes()) header = {file.width(), file.height(), true};
    if (format == Format::jpeg)
        if (const JpegFile file(bytes, name); file.is_of_light()) header = {file.width(), file.height(), true};
    if (header) check_size(header->width, header->height, bytes.size(), format, name);
    return header;
}

std::optional<StoredImage> decode_png_or_jpeg(std::span<const std::byte> bytes, Format format,
                                              const std::string& name) {
    if (!header_of_png_or_jpeg(bytes, format, name)) return std::nullopt;
    return format == Format::png ? decode_png(bytes, name) : decode_jpeg(bytes, name);
}

}  // namespace render2mpeg::image
