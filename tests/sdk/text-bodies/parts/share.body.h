/* share.body.h -- behind the pairs. */
neighbours = neighbours + 0.25;
spread = farthest / h;
