//! Serialisation of matrices as rows of numbers.

use faer::Mat;
use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error};

pub(crate) fn serialize<S: Serializer>(
    matrix: &Mat<f64>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    to_rows(matrix).serialize(serializer)
}

pub(crate) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Mat<f64>, D::Error> {
    let rows = Vec::<Vec<f64>>::deserialize(from)?;
    let columns = rows.first().map_or(0, Vec::len);
    if rows.iter().any(|row| row.len() != columns) {
        return Err(D::Error::custom("the rows of a matrix differ in length"));
    }
    Ok(Mat::from_fn(rows.len(), columns, |i, j| rows[i][j]))
}

pub(crate) fn to_rows(matrix: &Mat<f64>) -> Vec<Vec<f64>> {
    (0..matrix.nrows())
        .map(|i| (0..matrix.ncols()).map(|j| matrix[(i, j)]).collect())
        .collect()
}
