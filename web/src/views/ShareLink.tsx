// A link with the settings, to copy: it holds no data.

import { useState } from "preact/hooks";
import type { View } from "./Page";

export function ShareLink({ state, app }: View) {
  const [copied, setCopied] = useState<string | null>(null);
  const link = app.link(location.href);
  const copy = async () => {
    await navigator.clipboard?.writeText(link).catch(() => {});
    setCopied(link);
  };
  const holds = state.sample ? "the sample and the settings" : "the settings, not your files";
  return (
    <>
      <button type="button" onClick={copy} title={`A link to this page that holds ${holds}`}>Link to these settings</button>
      {copied === link && (
        <label class="link">Copied; it holds {holds}:
          <input type="text" readOnly value={link} onFocus={(event) => event.currentTarget.select()} />
        </label>
      )}
    </>
  );
}
