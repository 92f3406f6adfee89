/* Pictures, and averages of many samples for each pixel, by which colours are judged. */
#ifndef SHEEN_TESTS_ORACLE_SAMPLES_H
#define SHEEN_TESTS_ORACLE_SAMPLES_H

#include <cstdint>
#include <string>
#include <vector>

/* Rows top first. */
struct picture {
    int width_px = 0, height_px = 0;
    std::vector<uint8_t> rgb;
};

/* The picture of `sheen render MODEL --size WxH OPTIONS...`. Throws std::runtime_error with the
 * program's message if it fails. */
picture render_picture(const std::string &sheen, const std::string &model, int width_px,
                       int height_px, const std::vector<std::string> &options);

/* The mean of each value over scale x scale pixels of a picture, computed in linear light and
 * converted to sRGB, in 1/255. */
std::vector<double> averaged(const picture &large, int scale);

/* The largest difference of a channel for every pixel, in 1/255. Throws if the sizes differ. */
std::vector<double> differences(const picture &picture, const std::vector<double> &truth);

double mean_of(const std::vector<double> &values); /* NaN if empty */

#endif
