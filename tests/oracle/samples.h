/* Pictures, and the mean of many samples a pixel: what colours are judged by. */
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

/* What `sheen render MODEL --size WxH OPTIONS...` draws. Throws std::runtime_error with what it
 * says when it fails. */
picture render_picture(const std::string &sheen, const std::string &model, int width_px,
                       int height_px, const std::vector<std::string> &options);

/* Each value's mean over scale x scale pixels of a picture, taken in linear light and displayed, in
 * 1/255. */
std::vector<double> averaged(const picture &large, int scale);

/* The largest difference of a channel, of every pixel, in 1/255. Throws when sizes differ. */
std::vector<double> differences(const picture &picture, const std::vector<double> &truth);

double mean_of(const std::vector<double> &values); /* NaN of none */

#endif
