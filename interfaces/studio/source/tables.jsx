// Reports as tables, numbers as histograms, texts as they are.

const number = (value) => {
  if (typeof value !== "number") return value === null ? "–" : String(value);
  if (Number.isInteger(value)) return value.toLocaleString("en");
  return Math.abs(value) >= 1e5 || (value && Math.abs(value) < 1e-4) ? value.toExponential(2) : String(Number(value.toPrecision(4)));
};
const words = (name) => name.replaceAll("_", " ");
const isRows = (value) => Array.isArray(value) && value.length > 0 && value.every((each) => each && typeof each === "object" && !Array.isArray(each));
const isNumbers = (value) => Array.isArray(value) && value.length > 0 && value.every((each) => typeof each === "number" || each === null);

export function Table({ content }) {
  const entries = Object.entries(content), plain = entries.filter(([, value]) => value === null || typeof value !== "object");
  const deep = entries.filter(([, value]) => value !== null && typeof value === "object");
  return (
    <div className="report">
      {plain.length ? <dl>{plain.map(([name, value]) => <div key={name}><dt>{words(name)}</dt><dd>{typeof value === "boolean" ? (value ? "yes" : "no") : number(value)}</dd></div>)}</dl> : null}
      {deep.map(([name, value]) => <section key={name}>{name ? <h3>{words(name)}</h3> : null}<Deep value={value} name={name} /></section>)}
    </div>
  );
}

function Deep({ value, name }) {
  if (isRows(value)) return <Rows rows={value} />;
  if (isNumbers(value)) return value.length > 4 ? <Histogram values={value} label={words(name)} isSeries={value.length <= 60} /> : <p className="values">{value.map(number).join(", ")}</p>;
  if (Array.isArray(value)) return value.length ? <p className="values">{value.map((each) => (typeof each === "object" ? JSON.stringify(each) : number(each))).join(", ")}</p> : <p className="quiet">none</p>;
  return Object.keys(value).length ? <Table content={value} /> : <p className="quiet">none</p>;
}

function Rows({ rows }) {
  const columns = [...new Set(rows.slice(0, 50).flatMap(Object.keys))].filter((key) => rows.some((row) => row[key] === null || typeof row[key] !== "object" || isNumbers(row[key])));
  const cell = (value) => (isNumbers(value) ? <Spark values={value} /> : value !== null && typeof value === "object" ? "…" : number(value ?? null));
  return (
    <div className="scroll"><table><thead><tr>{columns.map((name) => <th key={name} scope="col">{words(name)}</th>)}</tr></thead>
      <tbody>{rows.slice(0, 400).map((row, i) => <tr key={i}>{columns.map((name) => <td key={name}>{cell(row[name])}</td>)}</tr>)}</tbody></table></div>
  );
}

function Spark({ values }) {
  const most = Math.max(...values.map((v) => Math.abs(v ?? 0))) || 1, w = 96 / values.length;
  return <svg className="spark" viewBox="0 0 96 22" role="img" aria-label={`${values.length} numbers`}>{values.map((v, i) => <rect key={i} x={i * w} width={Math.max(0.5, w - 0.6)} y={22 - (22 * Math.abs(v ?? 0)) / most} height={(22 * Math.abs(v ?? 0)) / most} />)}</svg>;
}

const BINS = 48;

/** How numbers are spread; a short series as it is. */
export function Histogram({ values, label, unit = "", isSeries = false }) {
  const known = values.filter((v) => v !== null && Number.isFinite(v));
  if (!known.length) return <p className="quiet">no number is finite</p>;
  const low = known.reduce((a, b) => Math.min(a, b)), high = known.reduce((a, b) => Math.max(a, b));
  const bins = isSeries ? known : new Array(BINS).fill(0);
  if (!isSeries) for (const v of known) bins[Math.min(BINS - 1, Math.floor(high > low ? ((v - low) / (high - low)) * BINS : BINS / 2))]++;
  const most = Math.max(...bins.map(Math.abs)) || 1, w = 480 / bins.length, mean = known.reduce((a, b) => a + b, 0) / known.length;
  const sign = unit === "deg" ? "°" : unit;
  return (
    <figure className="histogram">
      <svg viewBox="0 0 480 120" preserveAspectRatio="none" role="img" aria-label={`${label}: from ${number(low)} to ${number(high)}, mean ${number(mean)}`}>
        {bins.map((count, i) => { const h = (112 * Math.abs(count)) / most; return <rect key={i} x={i * w} width={Math.max(1, w - 1.5)} y={116 - h} height={Math.max(count ? 1.5 : 0, h)} />; })}
      </svg>
      <figcaption><span>{isSeries ? "first" : `${number(low)}${sign}`}</span><span>{isSeries ? `${number(low)} to ${number(high)}${sign}` : `mean ${number(mean)}${sign}`}</span><span>{isSeries ? "last" : `${number(high)}${sign}`}</span></figcaption>
    </figure>
  );
}

export function Numbers({ head, arrays }) {
  const values = [...(arrays.values ?? [])];
  return (
    <div className="report">
      <p className="quiet">{head.shape.length ? `${head.shape.join(" × ")} ${head.shape.length > 1 ? "numbers" : head.shape[0] === 1 ? "number" : "numbers"}` : "one number"}</p>
      {values.length > 1 ? <Histogram values={values} label={head.name} unit={head.unit} isSeries={values.length <= 40} /> : null}
      <p className="values">{head.rows.slice(0, 200).map((row) => (Array.isArray(row) ? `[${row.flat(3).slice(0, 12).map(number).join(", ")}]` : number(row))).join(head.shape.length > 1 ? "\n" : ", ")}</p>
    </div>
  );
}
